"""Beam of one infra-red sensor, and the motion of what it sees when the robot drives."""

import math
from typing import NamedTuple

from hal.odometry import WheelMotion
from hal.robot_settings import InfraredSettings

_DARK_RATIO = 0.9
"""Highest reading of a dark sensor, as a ratio of the reading right before a wall, where the law folds back."""
_DIGITS = 12
"""Sine and cosine differ in their last digits between platforms, and a replay compares bit for bit."""


class Beam(NamedTuple):
    """Place and direction of a sensor, and the numbers of its law."""

    place: int
    """Place in the sensor table."""
    sine: float
    """Sine of its heading."""
    cosine: float
    along_m: float
    """Place of the sensor along its beam, from the robot's centre, in m."""
    aside_m: float
    """Place of the sensor across its beam, to the left, in m."""
    numerator_counts_m: float
    offset_m: float
    bias_counts: float
    dark_counts: float
    """Lowest reading that may be of a sensor pressed against a wall, in counts."""

    def motion_m(self, counts: float, motion: WheelMotion) -> tuple[float, float]:
        """Return the motion of a standing obstacle that reads `counts` across the beam and along it, in m.

        `motion`: of the wheels. To the left of the beam and away from the sensor are positive.
        """
        distance_m = self.numerator_counts_m / (counts + self.bias_counts) - self.offset_m
        forward_m, turn_rad = motion.forward_m, motion.turn_rad
        return (
            forward_m * self.sine - turn_rad * (self.along_m + distance_m),
            turn_rad * self.aside_m - forward_m * self.cosine,
        )


def beam_of(infrared: InfraredSettings, place: int) -> Beam:
    """Return the beam of the sensor at `place` of the sensor table."""
    sensor = infrared.sensors[place]
    heading_rad = math.radians(sensor.heading_deg)
    sine, cosine = round(math.sin(heading_rad), _DIGITS), round(math.cos(heading_rad), _DIGITS)
    return Beam(
        place=place,
        sine=sine,
        cosine=cosine,
        along_m=sensor.x_m * cosine + sensor.y_m * sine,
        aside_m=sensor.y_m * cosine - sensor.x_m * sine,
        numerator_counts_m=infrared.numerator_counts_m,
        offset_m=infrared.offset_m,
        bias_counts=infrared.bias_counts,
        dark_counts=_DARK_RATIO * infrared.counts_at(infrared.fold_back_to_m),
    )
