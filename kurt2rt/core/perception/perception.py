"""Perception: senses in, situation out, once per tick."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from kurt2rt.core.perception.definition import SituationDefinition
from kurt2rt.core.perception.features import FeatureExtractor
from kurt2rt.core.perception.history import History


class Situation(NamedTuple):
    """Where the robot is in feature space."""

    vector: NDArray[np.float64]
    """Recent features, then the same averaged over the history; shape (dimensions,)."""
    history_frozen: bool
    """True while the robot waits for its teacher: the averages stand still."""


class Perception:
    """Turns SensorReadings into a Situation (paper, VI.B.1)."""

    def __init__(self, definition: SituationDefinition, sensors: tuple[str, ...]) -> None:
        self.definition = definition
        width = len(definition.features)
        self._extract = FeatureExtractor(definition, sensors)
        self._history = History(definition.history_steps, width)
        self._width = width
        self._driven = STANDSTILL

    def restart(self) -> None:
        """Forget what was, as a robot that has just been switched on."""
        self._history.clear()
        self._driven = STANDSTILL

    def perceive(self, senses: SensorReadings, *, history_frozen: bool) -> Situation:
        """Situation of this tick. While frozen the history keeps the steps before the robot stopped to ask."""
        recent = self._extract(senses.infrared_counts, self._driven)
        if self._history.filled == 0 and senses.infrared_age_s < math.inf:
            # A robot that was just switched on has no past; where it stands is the best guess of it.
            self._history.fill(recent)
        if not history_frozen:
            self._history.push(recent)
        vector = np.empty(2 * self._width)
        vector[: self._width] = recent
        self._history.average_into(vector[self._width :])
        return Situation(vector, history_frozen)

    def remember_driven(self, wheel_speeds: WheelSpeeds) -> None:
        """Set points of an action that was chosen; held while the robot waits, where nothing is chosen."""
        self._driven = wheel_speeds
