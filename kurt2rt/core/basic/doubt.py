"""Doubt: a score of the action that is about to drive, which grows where lessons say little about the situation."""

from collections.abc import Iterable, Mapping
from operator import sub
from typing import Annotated, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from behaviors.behaviour import Behaviour, DrivesOn, HasSetPoints
from config.settings import Settings
from hal.robot import WheelSpeeds
from hal.robot_settings import InfraredSettings
from kurt2rt.core.basic.obstacle_memory import ContactSettings, ObstacleMemory
from kurt2rt.core.perception.definition import Reading, SituationDefinition
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.settings_fields import or_left_out

_AHEAD_DEG = 60.0
"""A sensor looks ahead if its heading is nearer than this to the robot's: KURT2 has five such sensors."""

_RELEASE = 0.8
"""Fraction of the threshold below which a doubt ends: readings flicker, and the robot would creep on with them."""

_LESSONS = 2
"""A reading is new if fewer lessons than this were given at one as high, so that one wrong lesson hides no obstacle."""

_VERY_SITUATION = 0.5
"""Fraction of the usual distance up to which a situation is that of the lesson: noise takes less at a standstill."""


class DoubtSettings(Settings):
    """Scales of the two parts of doubt, and its threshold, as uncorrected drives gave them."""

    usual_distance: Annotated[float, Field(ge=0, le=1)]
    """Median of distance / R of an uncorrected drive where the robot was taught: no doubt up to it."""
    rare_distance: Annotated[float, Field(gt=0, le=1)]
    """99th percentile of it, which counts 1."""
    rare_counts: Annotated[float, Field(gt=0, le=1000)]
    """99th percentile of the counts by which a reading ahead exceeds the lessons; it counts 1."""
    threshold: Annotated[float, Field(gt=0, le=1000)]
    """Doubt from which the robot asks, chosen for a budget of questions in uncorrected drives."""
    asks: bool = True
    """Stand and ask at a doubt; False only tells the score."""
    alone: bool = False
    """Stand at a doubt if no teacher can be asked, too: in phase 5 and exams."""
    contact: Annotated[
        ContactSettings | None,
        or_left_out("settings, or leave the key out for a robot that remembers no obstacles"),
    ] = None
    """Remembered obstacles; an action that meets one is doubted by the threshold. None: none are remembered."""

    @model_validator(mode="after")
    def _rare_is_beyond_usual(self) -> Self:
        if self.rare_distance <= self.usual_distance:
            raise ValueError(f"rare_distance must be above usual_distance ({self.usual_distance:g})")
        return self


class NewObstacle(NamedTuple):
    """Finding of doubt: a sensor sees something nearer than it did in the lessons of actions that drive on."""

    feature: int
    """Index of the sensor's reading in the situation."""
    here: float
    """Its reading in counts."""
    taught: float
    """Reading that was taught, in counts."""

    @property
    def counts(self) -> float:
        """Counts by which the reading here exceeds the taught one."""
        return self.here - self.taught


def features_ahead(definition: SituationDefinition, infrared: InfraredSettings) -> tuple[int, ...]:
    """Return the indexes of the readings in a situation whose sensors look ahead, within 60 degrees.

    Doubt looks for new obstacles in these readings only.
    """
    headings = {sensor.name: sensor.heading_deg for sensor in infrared.sensors}
    return tuple(
        index
        for index, feature in enumerate(definition.features)
        if isinstance(feature, Reading) and abs(headings[feature.sensor]) < _AHEAD_DEG
    )


def actions_ahead(repertoire: Mapping[str, Behaviour]) -> frozenset[str]:
    """Return the names of the actions that drive forward, which a new obstacle ahead makes doubtful."""
    return frozenset(
        name for name, action in repertoire.items() if isinstance(action, DrivesOn) and action.forward_m_s > 0.0
    )


def set_points(repertoire: Mapping[str, Behaviour]) -> dict[str, WheelSpeeds]:
    """Return the wheel speeds in m/s, by name, of the actions whose way can be predicted."""
    return {name: action.wheel_speeds for name, action in repertoire.items() if isinstance(action, HasSetPoints)}


class DoubtMeter:
    """Score of an action inside R that lessons say little about; the robot asks from `threshold` on.

    score = (distance / R - usual) / (rare - usual) + (reading - taught) / rare_counts, each part at least 0. An
    action that would meet a remembered obstacle adds the threshold. 1 is usual for 1 % of the ticks of a drive.

    Deterministic: a function of the situation, the knowledge and the remembered obstacles.
    """

    def __init__(
        self,
        system: RlaSystem,
        settings: DoubtSettings,
        features: tuple[int, ...],
        actions: Iterable[str],
        memory: ObstacleMemory | None = None,
    ) -> None:
        """Connect the knowledge.

        Args:
            system: RLAs whose lessons count.
            settings: scales and threshold.
            features: indices of the readings that look ahead.
            actions: names of the actions that drive on.
            memory: remembered obstacles; its owner updates it once a tick. None: no contact is foreseen.
        """
        self.settings = settings
        self.memory = memory
        self._usual = settings.usual_distance
        self._per_distance = 1.0 / (settings.rare_distance - settings.usual_distance)
        self._per_count = 1.0 / settings.rare_counts
        self._system = system
        self._features = features
        self.actions = frozenset(actions)
        """Names of the actions that drive on."""
        self._rows: dict[tuple[int, str], tuple[float, ...]] = {}
        """Readings ahead in the condition of each RLA that drives on, by its id and image."""
        self._taught: dict[str, tuple[float, ...]] | None = None
        """Highest taught readings by behaviour; None after the knowledge changed."""
        self._nearest: tuple[int, str] | None = None
        """Nearest RLA of the last score since a lesson."""
        self._nearest_limits: tuple[float, ...] = ()

    def on_lesson(self) -> None:
        """Read the lessons again at the next score, because an RLA was created, changed or removed."""
        self._taught = self._nearest = None

    def score(self, situation: NDArray[np.float64], match: Match, action: str, behaviour: str) -> float:
        """Return the doubt about `action` in a situation (d,): 0 none, 1 as at 1 % of the ticks of a usual drive.

        `match`: nearest RLA of the situation. `behaviour`: active taught behaviour, whose lessons count.
        """
        rla = match.rla
        off = self._share(match) - self._usual
        score = off * self._per_distance if off > 0.0 else 0.0
        if action in self.actions:
            limits = self._limits(rla, behaviour)
            if limits:
                most = max(map(sub, map(situation.item, self._features), limits))
                if most > 0.0:
                    score += most * self._per_count
        if self._meets_obstacle(match, action):
            score += self.settings.threshold
        return score

    def _meets_obstacle(self, match: Match, action: str) -> bool:
        """Return whether the outline would soon meet a remembered obstacle if `action` drove.

        `match`: False if it is a lesson about this very situation, because its teacher saw the obstacle, too.
        """
        memory = self.memory
        if memory is None or not memory.meets(action):
            return False
        return self._share(match) > self._usual * _VERY_SITUATION

    def _share(self, match: Match) -> float:
        """Return distance / R, by the whole R also of a robot that asks sooner."""
        return match.distance * self._system.radius_share / match.radius if match.radius > 0.0 else 0.0

    def obstacle(self, situation: NDArray[np.float64], match: Match, action: str, behaviour: str) -> NewObstacle | None:
        """Return the sensor ahead that exceeds the lessons most in a situation (d,); None if none does.

        `match`: nearest RLA of the situation. `action`: None too if it does not drive on. `behaviour`: whose lessons
        count.
        """
        if action not in self.actions:
            return None
        limits = self._limits(match.rla, behaviour)
        found = [NewObstacle(i, situation.item(i), limit) for i, limit in zip(self._features, limits, strict=False)]
        most = max(found, key=lambda each: each.counts, default=None)
        return None if most is None or most.counts <= 0.0 else most

    def _limits(self, rla: Rla, behaviour: str) -> tuple[float, ...]:
        """Return the highest taught reading of each sensor ahead; empty before enough lessons.

        Readings of the nearest RLA count even if no other lesson has such: an answer ends the doubt that it is about.
        """
        nearest = rla.key
        if self._taught is None:
            self._taught = self._read_lessons()
        if self._nearest != nearest:
            limits, own = self._taught.get(behaviour, ()), self._rows.get(nearest)
            self._nearest = nearest
            self._nearest_limits = limits if own is None else tuple(map(max, limits, own))
        return self._nearest_limits

    def _read_lessons(self) -> dict[str, tuple[float, ...]]:
        rows: dict[tuple[int, str], tuple[float, ...]] = {}
        of: dict[str, list[tuple[float, ...]]] = {}
        for rla in self._system.matched_rlas:
            if rla.action in self.actions:
                row = rows[rla.key] = self._rows.get(rla.key) or self._row(rla)
                of.setdefault(rla.behaviour, []).append(row)
        self._rows = rows
        return {
            behaviour: tuple(sorted(column)[-_LESSONS] for column in zip(*taught, strict=True))
            for behaviour, taught in of.items()
            if len(taught) >= _LESSONS
        }

    def _row(self, rla: Rla) -> tuple[float, ...]:
        return tuple(rla.condition[i] for i in self._features)


class DoubtWatch:
    """Decision whether a level stands for doubt: from the threshold on, until a fraction of it."""

    def __init__(self, meter: DoubtMeter) -> None:
        """Begin without doubt."""
        self.meter = meter
        settings = meter.settings
        self._threshold, self._release = settings.threshold, settings.threshold * _RELEASE
        self._asks, self._stands_alone = settings.asks, settings.asks and settings.alone
        self._doubts = False

    def update(self, score: float, *, alone: bool) -> bool:
        """Count a tick with this dimensionless score of `DoubtMeter`; return whether the robot stands for doubt.

        `alone`: whether no teacher can be asked.
        """
        self._doubts = score >= (self._release if self._doubts else self._threshold)
        return self._doubts and (self._stands_alone if alone else self._asks)

    def end(self) -> None:
        """End a doubt, because the robot stands for another reason."""
        self._doubts = False
