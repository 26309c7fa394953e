"""Simulated lidar of a base."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hal.numerics import cos_sin
from hal.robot_settings import RobotSettings
from kurt2rt.robots.turtlebot.sectors import Sectors
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings, require_turtlebot
from kurt2rt.ros.laser_scan import Ranges, full_turn_scan
from simbridge.contracts.simulation import Pose
from simbridge.robot.noise import Noise
from simbridge.robot.ray_caster import faces_of
from simbridge.robot.world import World
from simbridge.worlds.world_settings import WorldSettings

_CORNER = 1e-9
"""Tolerance that keeps a ray from slipping between the two faces of a corner."""


class ScanReadings(list[int]):
    """Readings of all sectors in counts, with the ranges that they are of, in m, (rays,)."""

    def __init__(self, counts: Sequence[int], ranges_m: Ranges) -> None:
        super().__init__(counts)
        self.ranges_m = ranges_m


class Lidar:
    """Lidar that measures all its rays at once in each period (simbridge.simulated_robot.RangeSensors)."""

    def __init__(self, settings: TurtlebotSettings, world: World, noise: Noise) -> None:
        """Draw the phase and each ray's error from `noise`."""
        self._lidar, self._noise, self._cycle_s = settings.lidar, noise, settings.cycle_s
        self._world, self._sectors = world, Sectors(settings)
        self._angles_rad = np.linspace(0.0, math.tau, self._lidar.rays, endpoint=False)
        self._cycles_per_scan = round(self._lidar.period_s / self._cycle_s)
        self._cycles_left = 1 + int(noise.fraction() * self._cycles_per_scan)
        self.counts = ScanReadings([0] * len(settings.infrared.sensors), np.zeros(self._lidar.rays, np.float32))
        """Newest readings."""

    @property
    def due_s(self) -> Sequence[float]:
        """Time to the next scan, in s."""
        return (self._cycles_left * self._cycle_s,)

    def measure(self, pose: Pose) -> Sequence[int]:
        """Simulate one cycle at a pose and return the indexes of the sectors with new readings: all or none."""
        self._cycles_left -= 1
        if self._cycles_left > 0:
            return ()
        self._cycles_left = self._cycles_per_scan
        self.measure_all(pose)
        return range(len(self.counts))

    def measure_all(self, pose: Pose) -> None:
        """Take a scan at this pose; its sectors are `counts`."""
        limits_m = (self._lidar.nearest_m, self._lidar.farthest_m)
        exact_m = distances_m(self._world.settings, pose, pose.heading_rad + self._angles_rad)
        measured_m = exact_m + self._lidar.noise_m * self._noise.normals(self._lidar.rays)
        measured_m[measured_m < limits_m[0]] = -math.inf
        measured_m[measured_m > limits_m[1]] = math.inf
        ranges_m = measured_m.astype(np.float32)
        counts = self._sectors.counts(full_turn_scan(ranges_m, limits_m, self._lidar.period_s, 0.0))
        self.counts = ScanReadings([each or 0 for each in counts], ranges_m)


def distances_m(world: WorldSettings, pose: Pose, headings_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance in m to the nearest wall or obstacle in each direction, (n,); infinite without one.

    All rays at once: one by one they took a third of a simulation (simbridge.robot.ray_caster).
    """
    rays = np.array([cos_sin(each) for each in headings_rad.tolist()])
    ray_x, ray_y = rays[:, :1], rays[:, 1:]
    corner_x, corner_y, edge_x, edge_y = faces_of(world).T
    dx, dy = corner_x - pose.x_m, corner_y - pose.y_m
    with np.errstate(divide="ignore", invalid="ignore"):  # of a ray along a face: it hits the adjacent ones
        across = ray_x * edge_y - ray_y * edge_x
        away_m = (dx * edge_y - dy * edge_x) / across
        place = (dx * ray_y - dy * ray_x) / across
        hit = (away_m >= 0.0) & (place >= -_CORNER) & (place <= 1.0 + _CORNER)
    nearest_m: NDArray[np.float64] = np.where(hit, away_m, math.inf).min(axis=1)
    for post in world.round_obstacles:
        dx_m, dy_m = post.x_m - pose.x_m, post.y_m - pose.y_m
        along_m = dx_m * ray_x[:, 0] + dy_m * ray_y[:, 0]
        half_chord2 = post.radius_m * post.radius_m - (dx_m * dx_m + dy_m * dy_m - along_m * along_m)
        seen = (along_m > 0.0) & (half_chord2 >= 0.0)
        nearest_m[seen] = np.minimum(nearest_m, along_m - np.sqrt(np.maximum(half_chord2, 0.0)))[seen]
    return nearest_m


def lidar_of(robot: RobotSettings, world: World, noise: Noise, build: Noise) -> Lidar:  # noqa: ARG001 - all are alike
    """Return the simulated lidar of a base in a world, in place of infra-red sensors.

    It is a simbridge.simulated_robot.MakeSensors.
    """
    return Lidar(require_turtlebot(robot), world, noise)
