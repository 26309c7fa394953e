"""Perception: from sensor readings to the situation, once per tick."""

import math
import struct
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from kurt2rt.core.perception.definition import SituationDefinition
from kurt2rt.core.perception.features import FeatureExtractor
from kurt2rt.core.perception.history import History


class Situation(NamedTuple):
    """Feature vector of one tick."""

    vector: NDArray[np.float64]
    """Recent features, then their averages over the history; shape (dimensions,)."""
    history_frozen: bool
    """True while the robot waits for its teacher, and in ticks that a slow lesson adds: the averages do not change."""


class Perception:
    """Converter from SensorReadings to Situation (paper, section VI.B.1)."""

    def __init__(self, definition: SituationDefinition, sensors: tuple[str, ...]) -> None:
        self.definition = definition
        width = len(definition.features)
        self._extract = FeatureExtractor(definition, sensors)
        self._history = History(definition.history_steps, width)
        self._width = width
        # A struct writes the values into the vector in three quarters of the time of an array that is copied there.
        self._write: Callable[..., None] = struct.Struct(f"{width}d").pack_into
        self._driven = STANDSTILL

    def restart(self) -> None:
        """Reset to the state after power-on: no averages, and wheel speeds of 0."""
        self._history.clear()
        self._driven = STANDSTILL

    def perceive(self, readings: SensorReadings, *, history_frozen: bool) -> Situation:
        """Return the situation of this tick. Call it once per tick, because it adds a step to the averages.

        `history_frozen`: whether the averages stay as they are, because the robot waits or drives slowly.
        """
        vector = np.empty(2 * self._width)
        self._write(vector, 0, *self._extract(readings.infrared_counts, self._driven))
        recent = vector[: self._width]
        if self._history.filled == 0 and readings.infrared_age_s < math.inf:
            # After power-on the present is the best estimate of the past.
            self._history.fill(recent)
        if not history_frozen:
            self._history.push(recent)
        self._history.average_into(vector[self._width :])
        return Situation(vector, history_frozen)

    def remember_driven(self, wheel_speeds: WheelSpeeds) -> None:
        """Store the set points of the driven action; they are a feature until the next call."""
        self._driven = wheel_speeds
