"""Where the robot thinks it is: dead reckoning by its encoders, for whoever looks at a recording."""

import math
from typing import NamedTuple

from hal.robot_settings import GeometrySettings


class PlanePose(NamedTuple):
    """Position and heading from above, counter-clockwise from x."""

    x_m: float
    y_m: float
    heading_rad: float


class Odometry:
    """Reckons from where the robot was switched on, facing along x. Nothing is decided by it."""

    def __init__(self, geometry: GeometrySettings) -> None:
        self._metres_per_tick = geometry.metres_per_tick
        self._track_m = geometry.effective_track_m
        self.pose = PlanePose(0.0, 0.0, 0.0)

    def drive(self, left_ticks: int, right_ticks: int) -> None:
        """The wheels of the two sides have turned, forward positive."""
        left_m, right_m = left_ticks * self._metres_per_tick, right_ticks * self._metres_per_tick
        way_m, turn_rad = (left_m + right_m) / 2, (right_m - left_m) / self._track_m
        x_m, y_m, heading_rad = self.pose
        along_rad = heading_rad + turn_rad / 2
        self.pose = PlanePose(
            x_m + way_m * math.cos(along_rad),
            y_m + way_m * math.sin(along_rad),
            math.remainder(heading_rad + turn_rad, math.tau),
        )
