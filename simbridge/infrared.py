"""Infra-red distance sensors: free-running, noisy, each with own gain and phase (docs/the-robot.md#infra-red-law)."""

import math
from collections.abc import Sequence

from hal.robot_settings import InfraredSettings
from hal.simulation import Pose
from simbridge.noise import Noise
from simbridge.sight import RayCaster
from simbridge.world import World

_RECESS_M = 0.05
"""Rays start this far behind the sensor's face: a face that a wall touches must not look past it."""
_HIGHEST_COUNTS = 1023


class InfraredSensors:
    """Readings in raw counts, in the order of the robot's sensor table; each changes only when its sensor measures."""

    def __init__(self, settings: InfraredSettings, world: World, cycle_s: float, noise: Noise, robot: Noise) -> None:
        """What this robot's sensors are is drawn from `robot`: gains and periods; what they do now from `noise`."""
        self._law = settings
        self._cycle_s = cycle_s
        self._noise = noise
        self._noise_share = settings.noise_share
        self._noise_least = settings.noise_least_counts
        count = len(settings.sensors)
        self._gains = [1.0 + settings.gain_spread_share * share for share in robot.uniform(count)]
        self._periods_s = [
            max(cycle_s, settings.period_s + settings.period_spread_s * share) for share in robot.uniform(count)
        ]
        self._rays = [_rays_of(settings, i, world.settings.infrared_rays) for i in range(count)]
        self._ray_m = _RECESS_M + settings.far_m + 0.01  # so that a miss reads beyond far_m
        farthest_start_m = max(math.hypot(ray[0], ray[1]) for rays in self._rays for ray in rays)
        self._sight = RayCaster(world, farthest_start_m + self._ray_m)
        self.counts = [settings.floor_counts] * count
        self.due_s = [
            period_s * (1.0 + share) / 2 for period_s, share in zip(self._periods_s, noise.uniform(count), strict=True)
        ]
        """When each sensor measures next, on its own clock."""
        # A calendar of cycles: sensors that are not due cost nothing.
        self._calendar: list[list[int]] = [[] for _ in range(math.ceil(max(self._periods_s) / cycle_s) + 2)]
        self._cycle = 0
        for i, due_s in enumerate(self.due_s):
            self._calendar[int(due_s / cycle_s)].append(i)

    def measure(self, pose: Pose) -> Sequence[int]:
        """One cycle; returns which sensors have a new reading."""
        calendar, cycle = self._calendar, self._cycle
        self._cycle = cycle + 1
        today = cycle % len(calendar)
        due, calendar[today] = calendar[today], []
        self._read(due, pose)
        for i in due:
            due_s = self.due_s[i] = self.due_s[i] + self._periods_s[i]
            calendar[max(cycle + 1, int(due_s / self._cycle_s)) % len(calendar)].append(i)
        return due

    def measure_all(self, pose: Pose) -> None:
        """New readings of every sensor at once, for a robot that was just put down."""
        self._read(range(len(self.counts)), pose)

    def _read(self, sensors: Sequence[int], pose: Pose) -> None:
        # Most of the cost of a simulated cycle is here: names are looked up once, and no list is built.
        readings, gains, all_rays, ray_m = self.counts, self._gains, self._rays, self._ray_m
        counts_at, normal = self._law.counts_at, self._noise.normal
        noise_share, noise_least = self._noise_share, self._noise_least
        x_m, y_m, heading_rad = pose
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        self._sight.set_origin(x_m, y_m)
        distance_m = self._sight.distance_m
        for i in sensors:
            free_m = ray_m
            for ahead_m, left_m, along_x, along_y in all_rays[i]:
                free_m = distance_m(
                    x_m + ahead_m * cos - left_m * sin,
                    y_m + ahead_m * sin + left_m * cos,
                    along_x * cos - along_y * sin,
                    along_x * sin + along_y * cos,
                    free_m,
                )
            counts = counts_at(free_m - _RECESS_M) * gains[i]
            sigma = noise_share * counts
            reading = round(counts + (sigma if sigma > noise_least else noise_least) * normal())
            readings[i] = reading if 0 <= reading <= _HIGHEST_COUNTS else (_HIGHEST_COUNTS if reading > 0 else 0)


def _rays_of(settings: InfraredSettings, sensor: int, rays: int) -> list[tuple[float, float, float, float]]:
    """Each ray of a sensor in the body's frame: start ahead and left, direction ahead and left.

    The readings of a sensor with several rays are those of the nearest: each ray only looks as far as the one before.
    """
    place = settings.sensors[sensor]
    half_rad = settings.beam_width_rad / 2
    found = []
    for offset_rad in (0.0,) if rays == 1 else (0.0, half_rad, -half_rad):
        direction_rad = math.radians(place.heading_deg) + offset_rad
        cos, sin = math.cos(direction_rad), math.sin(direction_rad)
        found.append((place.x_m - _RECESS_M * cos, place.y_m - _RECESS_M * sin, cos, sin))
    return found
