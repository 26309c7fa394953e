"""What would have had to be otherwise: the smallest change of one reading with which the robot does something else."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.robot import STANDSTILL
from hal.robot_settings import InfraredSettings
from kurt2rt.explain.facts import DecisionFacts, LevelFacts, RlaStory
from kurt2rt.layers.decision import Cause
from kurt2rt.perception.definition import SituationDefinition, WheelSpeed
from kurt2rt.perception.features import FeatureExtractor
from kurt2rt.rla.rla import BASIC


@dataclass(frozen=True, slots=True)
class Tip:
    """One sensor that alone would have changed the decision."""

    sensor: str
    label: str
    counts: int
    """What it read."""
    needed_counts: int
    """The nearest reading to that with which another one answers, or none does."""
    distance_m: float
    """What it read, as the sensors' law has it."""
    needed_m: float
    rla: RlaStory | None
    """Who answers then; None: the robot stands and asks."""


def tips(facts: DecisionFacts, definition: SituationDefinition, law: InfraredSettings) -> tuple[Tip, ...]:
    """For each sensor that can do it alone the smallest change, the smallest of all first.

    `facts`: with all RLAs that may answer. The features are computed anew from the changed reading, so extremes and
    orientations follow it; averages stay. That another RLA says the same is no change. Empty where something else than
    the situation decided: an action that is held is held whatever is seen.
    """
    level, counts = facts.basic, facts.infrared_counts
    if facts.latched or facts.asks_at != BASIC or facts.cause not in (Cause.RLA, Cause.UNKNOWN):
        return ()
    stories = () if level.nearest is None else (level.nearest, *level.others)
    if level.driver is not None:  # of those on the very same condition the chosen one
        chosen = level.driver
        stories = (chosen, *(story for story in stories if story.condition != chosen.condition))
    if not stories or not level.euclidean:
        return ()
    rivals = _Rivals(level, stories)
    said = rivals.answer(np.array([level.vector]))[0]
    extract = FeatureExtractor(definition, law.names)
    width = len(definition.features)
    kept = [place for place, feature in enumerate(definition.features) if isinstance(feature, WheelSpeed)]
    found = []
    spread = 1 + 2 * law.gain_spread_share
    possible = set(range(round(law.floor_counts / spread), round(law.plateau_counts * spread) + 1))
    for place, sensor in enumerate(law.sensors):
        readings = sorted(possible - {counts[place]}, key=lambda each: _off(each, counts[place]))
        vectors = np.tile(np.array(level.vector), (len(readings), 1))
        for row, reading in enumerate(readings):
            changed = (*counts[:place], reading, *counts[place + 1 :])
            vectors[row, :width] = extract(changed, STANDSTILL)
        vectors[:, kept] = np.array(level.vector)[kept]
        answers = rivals.answer(vectors)
        first = next((row for row, answer in enumerate(answers) if _differ(answer, said)), None)
        if first is not None:
            needed = readings[first]
            found.append(
                Tip(
                    sensor.name,
                    sensor.label,
                    counts[place],
                    needed,
                    law.distance_m(counts[place]),
                    law.distance_m(needed),
                    answers[first],
                )
            )
    return tuple(sorted(found, key=lambda tip: _off(tip.needed_counts, tip.counts)))


class _Rivals:
    """All RLAs that may answer, oldest first, and who does at many situations at once."""

    def __init__(self, level: LevelFacts, stories: tuple[RlaStory, ...]) -> None:
        self._stories = sorted(stories, key=lambda story: story.rla_id)
        self._weights = np.array(level.weights)
        self._conditions = np.array([story.condition for story in self._stories]) * self._weights
        self._radii = np.array([story.radius for story in self._stories])

    def answer(self, vectors: NDArray[np.float64]) -> list[RlaStory | None]:
        """Of each row (n, d) who answers; None where nobody does: none is near enough, or its action was withdrawn."""
        weighted = vectors * self._weights
        squares = (
            (weighted**2).sum(axis=1)[:, np.newaxis]
            - 2 * weighted @ self._conditions.T
            + (self._conditions**2).sum(axis=1)
        )
        nearest = squares.argmin(axis=1)
        rows = np.arange(len(vectors))
        known = np.sqrt(np.maximum(squares[rows, nearest], 0.0)) <= self._radii[nearest]
        winners = [self._stories[place] for place in nearest.tolist()]
        return [
            winner if inside and not winner.asks else None
            for winner, inside in zip(winners, known.tolist(), strict=True)
        ]


def _off(reading: int, counts: int) -> int:
    return abs(reading - counts)


def _differ(one: RlaStory | None, other: RlaStory | None) -> bool:
    return (None if one is None else one.action) != (None if other is None else other.action)
