"""Sensor counterfactuals: the smallest change of one reading that changes the decision."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.robot_settings import InfraredSettings
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.perception.definition import SituationDefinition
from kurt2rt.core.perception.perception import compile_features
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.runs.explain.facts import DecisionFacts, LevelFacts, RlaFacts


@dataclass(frozen=True, slots=True)
class SensorCounterfactual:
    """Change of one sensor's reading that alone would have changed the decision."""

    sensor: str
    label: str
    counts: int
    """Recorded reading."""
    needed_counts: int
    """Reading nearest to `counts` at which another RLA answers, or none."""
    distance_m: float
    """Distance of `counts` by the sensor's calibration."""
    needed_m: float
    reads: str
    """Recorded reading in words."""
    needs: str
    """Needed reading in words."""
    rla: RlaFacts | None
    """RLA that answers at the needed reading; None if the robot asks there."""
    action: str | None
    """Action at the needed reading, the held action included; None if the robot asks."""


def sensor_counterfactuals(
    facts: DecisionFacts, definition: SituationDefinition, law: InfraredSettings
) -> tuple[SensorCounterfactual, ...]:
    """Return the smallest decisive change of each sensor, the smallest of all first.

    `facts` must hold all RLAs that may answer. Features are computed from the changed reading, so extremes,
    orientations and averages follow it. An RLA with the same action is no change. While an action is held only a
    question is one. Empty unless the situation alone decided, and in a tick with a lesson.
    """
    level, counts = facts.basic, facts.infrared_counts
    rlas = () if level.nearest is None else (level.nearest, *level.others)
    if not rlas or not level.euclidean or not _situation_decides(facts):
        return ()
    competitors = _Competitors(level, rlas, level.driver if facts.cause == DecisionCause.RLA else None)
    found = []
    changed = _ChangedSituations(facts, definition, law)
    words = words_for(law)
    spread = 1 + 2 * law.gain_spread_share
    possible = set(range(round(law.floor_counts / spread), round(law.plateau_counts * spread) + 1))
    for place, sensor in enumerate(law.sensors):
        if f"{sensor.label} ({sensor.name})" in facts.broken_sensors:
            continue  # its own reading changes nothing
        readings = sorted(possible - {counts[place]}, key=lambda each: _off(each, counts[place]))
        answers = competitors.answer(changed.vectors(place, readings))
        first = next(
            (row for row, answer in enumerate(answers) if _resulting_action(answer, facts.kept) != facts.action), None
        )
        if first is not None:
            needed, answer = readings[first], answers[first]
            found.append(
                SensorCounterfactual(
                    sensor=sensor.name,
                    label=sensor.label,
                    counts=counts[place],
                    needed_counts=needed,
                    distance_m=law.distance_m(counts[place]),
                    needed_m=law.distance_m(needed),
                    reads=words.reading(sensor.name, counts[place]),
                    needs=words.reading(sensor.name, needed),
                    rla=answer,
                    action=_resulting_action(answer, facts.kept),
                )
            )
    return tuple(sorted(found, key=lambda tip: _off(tip.needed_counts, tip.counts)))


def _situation_decides(facts: DecisionFacts) -> bool:
    """Return whether the situation alone made the robot drive or ask."""
    if (
        facts.taught_now
        or facts.latched
        or facts.asks_at != BASIC
        or facts.cause not in (DecisionCause.RLA, DecisionCause.HELD, DecisionCause.UNKNOWN)
    ):
        return False
    if facts.cause != DecisionCause.UNKNOWN:
        return True
    nearest = facts.basic.nearest
    lost = nearest is not None and nearest.distance <= nearest.radius and not nearest.asks
    return not lost and not facts.hindrances


class _ChangedSituations:
    """Situations of a decision with one reading changed."""

    def __init__(self, facts: DecisionFacts, definition: SituationDefinition, law: InfraredSettings) -> None:
        self._counts = facts.infrared_counts
        self._here = np.array(facts.basic.vector)
        follow = [feature for feature in definition.features if feature.sensors_used]
        self._compute = compile_features(follow, law.names)
        self._width = len(definition.features)
        self._following = [place for place, feature in enumerate(definition.features) if feature.sensors_used]
        self._average_gain = 0.0 if facts.history_frozen else 1 / definition.history_steps

    def vectors(self, sensor: int, readings: list[int]) -> NDArray[np.float64]:
        """Return the situation for each reading of the sensor, shape (n, d)."""
        counts, width = self._counts, self._width
        vectors = np.tile(self._here, (len(readings), 1))
        for row, reading in enumerate(readings):
            changed = *counts[:sensor], reading, *counts[sensor + 1 :]
            vectors[row, self._following] = self._compute(None, None, *changed)
        vectors[:, width:] += self._average_gain * (vectors[:, :width] - self._here[:width])
        return vectors


class _Competitors:
    """RLAs that may answer, evaluated for many situations at once."""

    def __init__(self, level: LevelFacts, rlas: tuple[RlaFacts, ...], driver: RlaFacts | None) -> None:
        """`driver`: the RLA that answers now."""
        groups: dict[tuple[float, ...], list[RlaFacts]] = {}
        for rla in sorted(rlas, key=lambda rla: rla.rla_id):
            groups.setdefault(rla.condition, []).append(rla)
        self._oldest = [group[0] for group in groups.values()]
        self._leaders = [_leader(group, driver) for group in groups.values()]
        self._weights = np.array(level.weights)
        self._conditions = np.array([rla.condition for rla in self._oldest]) * self._weights
        self._radii = np.array([rla.radius for rla in self._oldest])

    def answer(self, vectors: NDArray[np.float64]) -> list[RlaFacts | None]:
        """Return the RLA that answers each row of `vectors`, shape (n, d); None where the robot asks."""
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
    """Return the RLA that answers among those on one condition."""
    if driver is not None and driver.condition == group[0].condition:
        return driver
    return next((rla for rla in group if rla.leads), group[0])


def _resulting_action(answer: RlaFacts | None, kept: str) -> str | None:
    """Return the action that drives after `answer`; None if the robot asks."""
    return None if answer is None else kept or answer.action


def _off(reading: int, counts: int) -> int:
    return abs(reading - counts)
