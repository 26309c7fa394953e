"""The angle that a robot sweeps about a point."""

import math

from hal.simulation import Pose


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

    def interrupt(self) -> None:
        """Ignore the angle between the last pose and the next one."""
        self._angle_rad = None

    def update(self, pose: Pose) -> None:
        """Add the angle to this pose; the step must be less than half a round."""
        angle_rad = math.atan2(pose.y_m - self._y_m, pose.x_m - self._x_m)
        if self._angle_rad is not None:
            self.rounds += math.remainder(angle_rad - self._angle_rad, math.tau) / math.tau
        self._angle_rad = angle_rad
