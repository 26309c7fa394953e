"""Simulated lidar of a base."""

import math
from collections.abc import Sequence

import numpy as np

from hal.robot_settings import RobotSettings
from hal.simulation import Pose
from kurt2rt.robots.turtlebot.sectors import Sectors
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings, require_turtlebot
from kurt2rt.ros.laser_scan import Ranges, full_turn_scan
from simbridge.robot.noise import Noise
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.world import World


class ScanReadings(list[int]):
    """Readings of all sectors in counts, with the ranges that they are of, in m, (rays,)."""

    def __init__(self, counts: Sequence[int], ranges_m: Ranges) -> None:
        super().__init__(counts)
        self.ranges_m = ranges_m


class Lidar:
    """Lidar that measures all its rays at once in each period (simbridge.robot.range_sensors.RangeSensors)."""

    def __init__(self, settings: TurtlebotSettings, world: World, noise: Noise) -> None:
        """Draw the phase and each ray's error from `noise`."""
        self._lidar, self._noise, self._cycle_s = settings.lidar, noise, settings.cycle_s
        self._beyond_m = self._lidar.farthest_m + 1.0
        self._sight, self._sectors = RayCaster(world, self._beyond_m), Sectors(settings)
        angles_rad = [math.tau * ray / self._lidar.rays for ray in range(self._lidar.rays)]
        self._rays = [(0.0, 0.0, math.cos(angle_rad), math.sin(angle_rad)) for angle_rad in angles_rad]
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
        """Measure now."""
        limits_m = (self._lidar.nearest_m, self._lidar.farthest_m)
        turn = (math.cos(pose.heading_rad), math.sin(pose.heading_rad))
        self._sight.set_origin(pose.x_m, pose.y_m)
        least_m, beyond_m = self._sight.least_distance_m, self._beyond_m
        exact_m = np.array([least_m(pose, turn, (ray,), beyond_m) for ray in self._rays])
        measured_m = exact_m + self._lidar.noise_m * self._noise.normals(len(self._rays))
        measured_m[measured_m < limits_m[0]] = -math.inf
        measured_m[measured_m > limits_m[1]] = math.inf
        ranges_m = measured_m.astype(np.float32)
        counts = self._sectors.counts(full_turn_scan(ranges_m, limits_m, self._lidar.period_s, 0.0))
        self.counts = ScanReadings([each or 0 for each in counts], ranges_m)


def lidar_of(robot: RobotSettings, world: World, noise: Noise, build: Noise) -> Lidar:  # noqa: ARG001 - all are alike
    """Return the lidar of a base in a world (simbridge.simulated_robot.MakeSensors)."""
    return Lidar(require_turtlebot(robot), world, noise)
