"""What would have had to be otherwise: the smallest change of one reading with which the robot does something else."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.robot import STANDSTILL
from hal.robot_settings import InfraredSettings
from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.perception.definition import SituationDefinition, WheelSpeed
from kurt2rt.core.perception.features import FeatureExtractor
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.runs.explain.facts import DecisionFacts, LevelFacts, RlaFacts


@dataclass(frozen=True, slots=True)
class SensorCounterfactual:
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
    reads: str
    """The sensor's reading in words."""
    needs: str
    """The needed reading, in words."""
    rla: RlaFacts | None
    """Who answers then; None: the robot stands and asks."""
    action: str | None
    """What drives then: what that one says, or the action before it until its minimum time is over; None: it asks."""


def sensor_counterfactuals(
    facts: DecisionFacts, definition: SituationDefinition, law: InfraredSettings
) -> tuple[SensorCounterfactual, ...]:
    """For each sensor that can do it alone the smallest change, the smallest of all first.

    `facts`: with all RLAs that may answer. The features are computed anew from the changed reading, so extremes,
    orientations and averages follow it. That another RLA says the same is no change, and while an action keeps its
    minimum time another RLA is none either: only a question is. Empty where something else than the situation decided,
    and where something was taught in that tick: with another reading something else had been.
    """
    level, counts = facts.basic, facts.infrared_counts
    rlas = () if level.nearest is None else (level.nearest, *level.others)
    if not rlas or not level.euclidean or not _situation_decides(facts):
        return ()
    competitors = _Competitors(level, rlas, level.driver if facts.cause == Cause.RLA else None)
    found = []
    extract = FeatureExtractor(definition, law.names)
    width = len(definition.features)
    wheels = [place for place, feature in enumerate(definition.features) if isinstance(feature, WheelSpeed)]
    of_average = 0.0 if facts.history_frozen else 1 / definition.history_steps
    here = np.array(level.vector)
    words = words_for(law)
    spread = 1 + 2 * law.gain_spread_share
    possible = set(range(round(law.floor_counts / spread), round(law.plateau_counts * spread) + 1))
    for place, sensor in enumerate(law.sensors):
        readings = sorted(possible - {counts[place]}, key=lambda each: _off(each, counts[place]))
        vectors = np.tile(here, (len(readings), 1))
        for row, reading in enumerate(readings):
            vectors[row, :width] = extract((*counts[:place], reading, *counts[place + 1 :]), STANDSTILL)
        vectors[:, wheels] = here[wheels]
        vectors[:, width:] += of_average * (vectors[:, :width] - here[:width])
        answers = competitors.answer(vectors)
        first = next(
            (row for row, answer in enumerate(answers) if _resulting_action(answer, facts.kept) != facts.action), None
        )
        if first is not None:
            needed, answer = readings[first], answers[first]
            found.append(
                SensorCounterfactual(
                    sensor.name,
                    sensor.label,
                    counts[place],
                    needed,
                    law.distance_m(counts[place]),
                    law.distance_m(needed),
                    words.reading(sensor.name, counts[place]),
                    words.reading(sensor.name, needed),
                    answer,
                    _resulting_action(answer, facts.kept),
                )
            )
    return tuple(sorted(found, key=lambda tip: _off(tip.needed_counts, tip.counts)))


def _situation_decides(facts: DecisionFacts) -> bool:
    """Whether what the robot saw, and nothing else, had it drive or ask."""
    if (
        facts.taught_now
        or facts.latched
        or facts.asks_at != BASIC
        or facts.cause not in (Cause.RLA, Cause.HELD, Cause.UNKNOWN)
    ):
        return False
    if facts.cause != Cause.UNKNOWN:
        return True
    nearest = facts.basic.nearest
    lost = nearest is not None and nearest.distance <= nearest.radius and not nearest.asks
    return not lost and not facts.hindrances


class _Competitors:
    """All RLAs that may answer, and who does at many situations at once."""

    def __init__(self, level: LevelFacts, rlas: tuple[RlaFacts, ...], driver: RlaFacts | None) -> None:
        """`driver`: the one that answers now."""
        groups: dict[tuple[float, ...], list[RlaFacts]] = {}
        for rla in sorted(rlas, key=lambda rla: rla.rla_id):
            groups.setdefault(rla.condition, []).append(rla)
        self._oldest = [group[0] for group in groups.values()]
        self._leaders = [_leader(group, driver) for group in groups.values()]
        self._weights = np.array(level.weights)
        self._conditions = np.array([rla.condition for rla in self._oldest]) * self._weights
        self._radii = np.array([rla.radius for rla in self._oldest])

    def answer(self, vectors: NDArray[np.float64]) -> list[RlaFacts | None]:
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
        return [
            self._leaders[place] if inside and not self._oldest[place].asks else None
            for place, inside in zip(nearest.tolist(), known.tolist(), strict=True)
        ]


def _leader(group: list[RlaFacts], driver: RlaFacts | None) -> RlaFacts:
    """Of those on one condition the one that drives, or would."""
    if driver is not None and driver.condition == group[0].condition:
        return driver
    return next((rla for rla in group if rla.leads), group[0])


def _resulting_action(answer: RlaFacts | None, kept: str) -> str | None:
    """What drives where that one answers; None: the robot asks."""
    return None if answer is None else kept or answer.action


def _off(reading: int, counts: int) -> int:
    return abs(reading - counts)
