"""The angle that a robot sweeps about a point."""

import math
from collections.abc import Sequence

from behaviors.metrics.task_metric import Metrics
from hal.numerics import round_portable
from simbridge.contracts.simulation import Pose


class AngleAbout:
    """Sum of the swept angle in whole rounds, counter-clockwise positive."""

    def __init__(self, x_m: float, y_m: float) -> None:
        self.rounds = 0.0
        self._x_m = x_m
        self._y_m = y_m
        self._angle_rad: float | None = None

    def away_m(self, pose: Pose) -> float:
        """Return the distance in m from the centre of the angle to the robot's centre."""
        return math.hypot(pose.x_m - self._x_m, pose.y_m - self._y_m)

    def all_away_m(self, poses: Sequence[Pose]) -> list[float]:
        """Return the distance in m from the centre of the angle to the robot's centre at each pose."""
        return [math.hypot(x_m - self._x_m, y_m - self._y_m) for x_m, y_m, _ in poses]

    def interrupt(self) -> None:
        """Ignore the angle between the last pose and the next one."""
        self._angle_rad = None

    def update(self, pose: Pose) -> None:
        """Add the angle to this pose; the step must be less than half a round."""
        angle_rad = round_portable(math.atan2(pose.y_m - self._y_m, pose.x_m - self._x_m))
        if self._angle_rad is not None:
            self.rounds += math.remainder(angle_rad - self._angle_rad, math.tau) / math.tau
        self._angle_rad = angle_rad

    def update_all(self, poses: Sequence[Pose]) -> None:
        """Add the angles to poses in a row, as one call of `update` for each would."""
        angles_rad = [round_portable(math.atan2(y_m - self._y_m, x_m - self._x_m)) for x_m, y_m, _ in poses]
        if not angles_rad:
            return
        rounds, before_rad = self.rounds, angles_rad[0] if self._angle_rad is None else self._angle_rad
        for angle_rad in angles_rad:
            rounds += math.remainder(angle_rad - before_rad, math.tau) / math.tau
            before_rad = angle_rad
        self.rounds, self._angle_rad = rounds, before_rad


MEASURE_EVERY = 10
"""Ticks from one measured distance to the next."""


class Mean:
    """Arithmetic mean of the values that a metric adds during a drive, such as distance errors in m."""

    def __init__(self) -> None:
        self._sum = 0.0
        self._count = 0

    def add(self, value: float) -> None:
        """Add a value, in the unit of the metric, such as m."""
        self._sum += value
        self._count += 1

    def as_metric(self, name: str) -> Metrics:
        """Return the mean by its name, {name: mean}; empty without values."""
        return {name: self._sum / self._count} if self._count else {}
