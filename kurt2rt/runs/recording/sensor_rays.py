"""Rays of the distance sensors in the robot's frame."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from hal.robot_settings import InfraredSettings

SCAN_STEP_DEG = 3
SCAN_RAYS = 360 // SCAN_STEP_DEG


class Ray(NamedTuple):
    """Line of sight of one sensor; x forward, y left, in m."""

    from_x_m: float
    from_y_m: float
    to_x_m: float
    to_y_m: float
    seen: bool
    """True if it ends at an obstacle; otherwise it ends at the sensor's range."""


class SensorRays:
    """Conversion of infra-red counts to rays, and to a scan with equal angles."""

    def __init__(self, infrared: InfraredSettings) -> None:
        self._infrared = infrared
        self._places = [
            (sensor.x_m, sensor.y_m, math.cos(heading_rad), math.sin(heading_rad))
            for sensor in infrared.sensors
            for heading_rad in [math.radians(sensor.heading_deg)]
        ]

    def rays(self, counts: Sequence[int]) -> list[Ray]:
        """Return the ray of each sensor in the order of `counts`."""
        infrared = self._infrared
        rays = []
        for (x_m, y_m, dx, dy), count in zip(self._places, counts, strict=True):
            away_m = infrared.distance_m(count)
            rays.append(Ray(x_m, y_m, x_m + away_m * dx, y_m + away_m * dy, away_m < infrared.far_m))
        return rays

    def scan_m(self, counts: Sequence[int]) -> list[float]:
        """Return distances from the centre, counter-clockwise from x every SCAN_STEP_DEG; infinite without obstacle.

        A sensor's hit is entered in the nearest ray, at most half a step off.
        """
        ranges = [math.inf] * SCAN_RAYS
        for ray in self.rays(counts):
            if ray.seen:
                place = round(math.degrees(math.atan2(ray.to_y_m, ray.to_x_m)) / SCAN_STEP_DEG) % SCAN_RAYS
                ranges[place] = min(ranges[place], math.hypot(ray.to_x_m, ray.to_y_m))
        return ranges
