"""Infra-red distance sensors: free-running, noisy, each with own gain and phase (docs/the-robot.md#infra-red-law)."""

import math
from collections.abc import Sequence

from hal.infrared_law import counts_at
from hal.numerics import cos_sin
from hal.robot_settings import InfraredSettings
from simbridge.contracts.simulation import Pose
from simbridge.robot.noise import Noise
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.world import World

RECESS_M = 0.05
"""Distance from a ray's start to the sensor's face in front of it, so that a touching wall is still hit."""
_HIGHEST_COUNTS = 1023


class InfraredSensors:
    """Raw counts in the order of the sensor table; each reading changes only when its sensor measures."""

    def __init__(self, settings: InfraredSettings, world: World, cycle_s: float, noise: Noise, robot: Noise) -> None:
        """Draw the sensors' gains and periods from `robot`, phases and readings from `noise`."""
        self._law = settings.law
        self._cycle_s = cycle_s
        self._noise = noise
        self._noise_ratio = settings.noise_share
        self._noise_least = settings.noise_least_counts
        count = len(settings.sensors)
        self.gains = [1.0 + settings.gain_spread_share * draw for draw in robot.uniform(count)]
        self.periods_s = [
            max(cycle_s, settings.period_s + settings.period_spread_s * draw) for draw in robot.uniform(count)
        ]
        self.rays = [_rays_of(settings, i, world.settings.infrared_rays) for i in range(count)]
        self.ray_m = RECESS_M + settings.far_m + 0.01  # so that a miss reads beyond far_m
        farthest_start_m = max(math.hypot(ray[0], ray[1]) for rays in self.rays for ray in rays)
        self.reach_m = farthest_start_m + self.ray_m
        self._sight = RayCaster(world, self.reach_m)
        self.counts = [settings.floor_counts] * count
        self.due_s = [
            period_s * (1.0 + draw) / 2 for period_s, draw in zip(self.periods_s, noise.uniform(count), strict=True)
        ]
        """Time of each sensor's next measurement."""
        # Ring buffer of cycles: sensors that are not due cost nothing.
        self.calendar: list[list[int]] = [[] for _ in range(math.ceil(max(self.periods_s) / cycle_s) + 2)]
        self._cycle = 0
        for i, due_s in enumerate(self.due_s):
            self.calendar[int(due_s / cycle_s)].append(i)

    def measure(self, pose: Pose) -> Sequence[int]:
        """Simulate one cycle at a pose and return the indexes of the sensors with new readings."""
        calendar, cycle = self.calendar, self._cycle
        self._cycle = cycle + 1
        slot = cycle % len(calendar)
        due, calendar[slot] = calendar[slot], []
        self._read(due, pose)
        for i in due:
            due_s = self.due_s[i] = self.due_s[i] + self.periods_s[i]
            calendar[max(cycle + 1, int(due_s / self._cycle_s)) % len(calendar)].append(i)
        return due

    def measure_all(self, pose: Pose) -> None:
        """Measure with all sensors at once, for a repositioned robot."""
        self._read(range(len(self.counts)), pose)

    def _read(self, sensors: Sequence[int], pose: Pose) -> None:
        # The most expensive part of a cycle: names are looked up once.
        readings, gains, all_rays, ray_m, law = self.counts, self.gains, self.rays, self.ray_m, self._law
        noise_ratio, noise_least = self._noise_ratio, self._noise_least
        turn = cos_sin(pose.heading_rad)
        self._sight.set_origin(pose.x_m, pose.y_m)
        least_distance_m = self._sight.least_distance_m
        for i, noise in zip(sensors, self._noise.next_normals(len(sensors)), strict=True):
            free_m = least_distance_m(pose, turn, all_rays[i], ray_m)
            counts = counts_at(free_m - RECESS_M, law) * gains[i]
            sigma = noise_ratio * counts
            reading = round(counts + (sigma if sigma > noise_least else noise_least) * noise)
            readings[i] = reading if 0 <= reading <= _HIGHEST_COUNTS else (_HIGHEST_COUNTS if reading > 0 else 0)


def _rays_of(settings: InfraredSettings, sensor: int, rays: int) -> list[tuple[float, float, float, float]]:
    """Return the rays of a sensor in the body's frame: start (ahead, left) and direction (ahead, left).

    A sensor with several rays reads the nearest hit, so each ray only looks as far as the one before.
    """
    place = settings.sensors[sensor]
    half_rad = settings.beam_width_rad / 2
    found = []
    for offset_rad in (0.0,) if rays == 1 else (0.0, half_rad, -half_rad):
        direction_rad = math.radians(place.heading_deg) + offset_rad
        cos, sin = cos_sin(direction_rad)
        found.append((place.x_m - RECESS_M * cos, place.y_m - RECESS_M * sin, cos, sin))
    return found
