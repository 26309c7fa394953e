"""Perception: from sensor readings to the situation, once per tick."""

import math
import struct
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.perception.definition import Feature, SituationDefinition


def compile_features(features: Iterable[Feature], sensors: Sequence[str]) -> Callable[..., tuple[int, ...]]:
    """Return the function from `readings`, `driven` and the count of each sensor to the features (paper, VI.B.1).

    `readings` are SensorReadings, `driven` the last set points, left and right, by the scale of the definition.
    """
    count = {name: f"c{index}" for index, name in enumerate(sensors)}
    # One compiled expression takes a third of the time of one call per feature, each tick.
    values = [each.expression([count[name] for name in each.sensors_used]) for each in features]
    parameters, tuple_of_all = ", ".join(count.values()), "".join(f"{value}, " for value in values)
    compute: Callable[..., tuple[int, ...]] = eval(f"lambda readings, driven, {parameters}: ({tuple_of_all})")
    return compute


class Situation(NamedTuple):
    """Feature vector of one tick, which the levels compare with conditions (paper, section VI.B.1).

    With `config/situations/basic.yaml` it has 72 values: 36 of now, then their averages over 10 s of driving.
    `Perception` makes one in each tick with fresh readings; no reader changes it.
    """

    vector: NDArray[np.float64]
    """Recent features, then their averages over the history; shape (dimensions,)."""
    history_frozen: bool
    """True while the robot waits for its teacher, and in ticks that a slow lesson adds: the averages do not change."""


class History:
    """Last `steps` feature vectors and their sum; whole numbers below 2**53, so the running sum never drifts."""

    def __init__(self, steps: int, width: int) -> None:
        self._ring = np.zeros((steps, width))
        self._sums = np.zeros(width)
        self._next = 0
        self.filled = 0
        """Number of steps held, at most the ring's length."""
        self._divisor = np.ones(width)
        """Number of steps held, at least 1, for each value: numpy divides by a single number in twice the time."""

    def push(self, values: NDArray[np.float64]) -> None:
        """Append the features of one step, shape (width,), in the features' units; a full ring drops the oldest.

        Values must be whole numbers, as counts are, so that the sum stays exact.
        """
        row = self._ring[self._next]
        self._sums += values
        self._sums -= row  # zeros until the ring is full
        row[:] = values
        self._next += 1
        if self._next == len(self._ring):
            self._next = 0
        if self.filled < len(self._ring):
            self._set_filled(self.filled + 1)

    def fill(self, values: NDArray[np.float64]) -> None:
        """Set every step to `values`, shape (width,), in the features' units, as if the robot had always been here."""
        self._ring[:] = values
        self._sums[:] = len(self._ring) * values
        self._set_filled(len(self._ring))

    def clear(self) -> None:
        """Remove all steps; the averages are zeros then."""
        self._ring[:] = 0
        self._sums[:] = 0
        self._next = 0
        self._set_filled(0)

    def average_into(self, out: NDArray[np.float64]) -> None:
        """Write the mean of all steps to `out`, float64 of shape (width,), in the features' units.

        Writes zeros before the first step.
        """
        np.divide(self._sums, self._divisor, out)

    def _set_filled(self, steps: int) -> None:
        self.filled = steps
        self._divisor.fill(max(steps, 1))


class Perception:
    """Source of each tick's situation: recent features and their averages over time (paper, VI.B.1)."""

    def __init__(self, definition: SituationDefinition, sensors: tuple[str, ...]) -> None:
        self.definition = definition
        width = len(definition.features)
        self._compute = compile_features(definition.features, sensors)
        self._history = History(definition.history_steps, width)
        self._width = width
        # A struct writes the values into the vector in three quarters of the time of an array that is copied there.
        self._write: Callable[..., None] = struct.Struct(f"{width}d").pack_into
        self._driven = (0, 0)

    def restart(self) -> None:
        """Reset to the state after power-on: no averages, and wheel speeds of 0."""
        self._history.clear()
        self._driven = (0, 0)

    def perceive(self, readings: SensorReadings, *, history_frozen: bool) -> Situation:
        """Return the situation of this tick. Call it once per tick, because it adds a step to the averages.

        `history_frozen`: whether the averages stay as they are, because the robot waits or drives slowly.
        """
        vector = np.empty(2 * self._width)
        self._write(vector, 0, *self._compute(readings, self._driven, *readings.infrared_counts))
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
        if scale := self.definition.wheel_speed_counts_per_m_s:
            self._driven = round(wheel_speeds.left_m_s * scale), round(wheel_speeds.right_m_s * scale)
