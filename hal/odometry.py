"""Dead reckoning from the wheel encoders."""

from typing import NamedTuple

from hal.numerics import cos_sin
from hal.robot_settings import GeometrySettings


class WheelMotion(NamedTuple):
    """Motion of one look by the encoders: ways of both sides and the centre in m, turn to the left in rad."""

    left_m: float
    right_m: float
    forward_m: float
    turn_rad: float


class PlanePose(NamedTuple):
    """Dead-reckoned pose: x and y in m, heading in rad counter-clockwise from x, which counts whole turns."""

    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0

    def moved(self, forward_m: float, turn_rad: float) -> "PlanePose":
        """Return the pose after an arc of `forward_m`, taken along its middle heading, which counts whole turns."""
        cos, sin = cos_sin(self.heading_rad + turn_rad / 2)
        return PlanePose(self.x_m + forward_m * cos, self.y_m + forward_m * sin, self.heading_rad + turn_rad)


class WheelOdometry:
    """Encoder ticks as motion. Replay compares bit for bit, so these operations keep their order."""

    def __init__(self, geometry: GeometrySettings) -> None:
        self._metres_per_tick = geometry.metres_per_tick
        self._track_m = geometry.effective_track_m

    def motion(self, left_ticks: int, right_ticks: int) -> WheelMotion:
        """Return the motion that turned the wheels by these ticks, forward positive."""
        left_m, right_m = left_ticks * self._metres_per_tick, right_ticks * self._metres_per_tick
        return WheelMotion(left_m, right_m, (left_m + right_m) / 2, (right_m - left_m) / self._track_m)
