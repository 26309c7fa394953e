"""Simulated lidar of a base."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hal.robot_settings import RobotSettings
from hal.simulation import Pose
from kurt2rt.robots.turtlebot.sectors import Sectors
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings, require_turtlebot
from kurt2rt.ros.messages import Header, LaserScan, to_time
from simbridge.robot.noise import Noise
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.world import World

Ranges = NDArray[np.float32]


class ScanReadings(list[int]):
    """Readings of all sectors in counts, with the ranges that they are of, in m, (rays,)."""

    def __init__(self, counts: Sequence[int], ranges_m: Ranges) -> None:
        super().__init__(counts)
        self.ranges_m = ranges_m


class Lidar:
    """Lidar that measures all its rays at once in each period (simbridge.robot.range_sensors.RangeSensors)."""

    def __init__(self, settings: TurtlebotSettings, world: World, noise: Noise) -> None:
        """Draw the phase and each ray's error from `noise`."""
        lidar, self._settings, self._noise = settings.lidar, settings, noise
        self._sight = RayCaster(world, lidar.farthest_m)
        angles_rad = [math.tau * ray / lidar.rays for ray in range(lidar.rays)]
        self._rays = [(0.0, 0.0, math.cos(angle_rad), math.sin(angle_rad)) for angle_rad in angles_rad]
        self._sectors = Sectors(settings)
        self._cycles_per_scan = round(lidar.period_s / settings.cycle_s)
        self._cycles_left = 1 + int(noise.fraction() * self._cycles_per_scan)
        self.counts = ScanReadings([0] * len(settings.infrared.sensors), np.zeros(lidar.rays, dtype=np.float32))
        """Newest readings."""

    @property
    def due_s(self) -> Sequence[float]:
        """Time to the next scan, in s."""
        return (self._cycles_left * self._settings.cycle_s,)

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
        lidar = self._settings.lidar
        turn = (math.cos(pose.heading_rad), math.sin(pose.heading_rad))
        self._sight.set_origin(pose.x_m, pose.y_m)
        least_m, beyond_m = self._sight.least_distance_m, lidar.farthest_m + 1.0
        exact_m = np.array([least_m(pose, turn, (ray,), beyond_m) for ray in self._rays])
        measured_m = exact_m + lidar.noise_m * self._noise.normals(lidar.rays)
        missed = (exact_m >= beyond_m) | (measured_m > lidar.farthest_m) | (measured_m < lidar.nearest_m)
        ranges_m = np.where(missed, np.where(measured_m < lidar.nearest_m, -math.inf, math.inf), measured_m)
        ranges_m = ranges_m.astype(np.float32)
        counts = self._sectors.counts(scan_message(self._settings, ranges_m, 0.0))
        self.counts = ScanReadings([0 if each is None else each for each in counts], ranges_m)


def scan_message(settings: TurtlebotSettings, ranges_m: Ranges, stamp_s: float) -> LaserScan:
    """Return the message of ranges in m, (rays,), that were measured at `stamp_s`."""
    lidar = settings.lidar
    step_rad = math.tau / lidar.rays
    return LaserScan(
        header=Header(to_time(stamp_s), "base_scan"),
        angle_min=0.0,
        angle_max=step_rad * (lidar.rays - 1),
        angle_increment=step_rad,
        time_increment=0.0,
        scan_time=lidar.period_s,
        range_min=lidar.nearest_m,
        range_max=lidar.farthest_m,
        ranges=ranges_m,
        intensities=np.zeros(0, dtype=np.float32),
    )


def lidar_of(robot: RobotSettings, world: World, noise: Noise, build: Noise) -> Lidar:  # noqa: ARG001 - all are alike
    """Return the lidar of a base in a world (simbridge.simulated_robot.MakeSensors)."""
    return Lidar(require_turtlebot(robot), world, noise)
