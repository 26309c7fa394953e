"""The infra-red distance sensors: free-running, noisy, each with its own gain and phase (reference 3)."""

import math
from collections.abc import Sequence

from hal.robot_settings import InfraredSettings
from simbridge.noise import Noise
from simbridge.pose import Pose
from simbridge.world import World

_RECESS_M = 0.05
"""Rays start this far behind the sensor's face: a face that a wall touches must not look past it."""
_HIGHEST_COUNTS = 1023


class InfraredSensors:
    """Readings in raw counts, in the order of the robot's sensor table; each changes only when its sensor measures."""

    def __init__(self, settings: InfraredSettings, world: World, cycle_s: float, noise: Noise) -> None:
        self._law = settings
        self._world = world
        self._cycle_s = cycle_s
        self._noise = noise
        count = len(settings.sensors)
        self._gains = [1.0 + settings.gain_spread_share * share for share in noise.uniform(count)]
        self._periods_s = [
            max(cycle_s, settings.period_s + settings.period_spread_s * share) for share in noise.uniform(count)
        ]
        self._rays = [_rays_of(settings, i, world.settings.infrared_rays) for i in range(count)]
        self._reach_m = _RECESS_M + settings.far_m + 0.01
        self.counts = [settings.floor_counts] * count
        # A calendar of cycles, so that sensors that are not due cost nothing.
        self._calendar: list[list[int]] = [[] for _ in range(math.ceil(max(self._periods_s) / cycle_s) + 2)]
        self._cycle = 0
        self.due_s = [
            period_s * (share + 1) / 2 for period_s, share in zip(self._periods_s, noise.uniform(count), strict=True)
        ]
        for i, due_s in enumerate(self.due_s):
            self._calendar[int(due_s / cycle_s)].append(i)

    def measure(self, pose: Pose) -> Sequence[int]:
        """One cycle; returns which sensors have a new reading."""
        calendar, cycle = self._calendar, self._cycle
        due = calendar[cycle % len(calendar)]
        calendar[cycle % len(calendar)] = []
        self._cycle = cycle + 1
        cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
        for i in due:
            self.counts[i] = self._reading(i, pose.x_m, pose.y_m, cos, sin)
            due_s = self.due_s[i] = self.due_s[i] + self._periods_s[i]
            calendar[max(cycle + 1, int(due_s / self._cycle_s)) % len(calendar)].append(i)
        return due

    def measure_all(self, pose: Pose) -> None:
        """New readings of every sensor at once, for a robot that was just put down."""
        cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
        for i in range(len(self.counts)):
            self.counts[i] = self._reading(i, pose.x_m, pose.y_m, cos, sin)

    def _reading(self, sensor: int, x_m: float, y_m: float, cos: float, sin: float) -> int:
        free = 1.0
        for ahead_m, left_m, reach_ahead_m, reach_left_m in self._rays[sensor]:
            free = min(
                free,
                self._world.free_share(
                    (x_m + ahead_m * cos - left_m * sin, y_m + ahead_m * sin + left_m * cos),
                    (x_m + reach_ahead_m * cos - reach_left_m * sin, y_m + reach_ahead_m * sin + reach_left_m * cos),
                ),
            )
        law = self._law
        counts = law.counts_at(max(0.0, free * self._reach_m - _RECESS_M)) * self._gains[sensor]
        counts += max(law.noise_least_counts, law.noise_share * counts) * self._noise.normal()
        return min(_HIGHEST_COUNTS, max(0, round(counts)))


def _rays_of(settings: InfraredSettings, sensor: int, rays: int) -> list[tuple[float, float, float, float]]:
    """Start and end of each ray of a sensor in the body's frame (ahead, left, ahead, left)."""
    place = settings.sensors[sensor]
    reach_m = settings.far_m + 0.01
    offsets_rad = [0.0] if rays == 1 else [0.0, settings.beam_width_rad / 2, -settings.beam_width_rad / 2]
    found = []
    for offset_rad in offsets_rad:
        direction_rad = math.radians(place.heading_deg) + offset_rad
        cos, sin = math.cos(direction_rad), math.sin(direction_rad)
        found.append(
            (
                place.x_m - _RECESS_M * cos,
                place.y_m - _RECESS_M * sin,
                place.x_m + reach_m * cos,
                place.y_m + reach_m * sin,
            )
        )
    return found
