"""Random free poses in a world."""

import math
import random

from config.settings import SettingsError
from hal.numerics import cos_sin
from hal.robot_settings import RobotSettings
from simbridge.contracts.simulation import Pose
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.world import World

_CLEARANCE_M = 0.1
"""Wall clearance that is enough for a robot to turn on the spot; less is enough for a small one."""
_CLOSE_M = 0.015
"""Least wall clearance of a pose close to things; a smaller one may start with a collision."""
_IN_SIGHT_M = 0.45
"""Distance at which a sensor that sees as far hardly detects an object."""
_ON_A_POST_M = 0.001
_TRIES = 100_000
"""Limit of tries; a single small post in a large room needs some thousands."""


class FreePoses:
    """Sampler of collision-free poses at which a robot can be set down with something in view.

    That is a post, if the world has posts.
    """

    def __init__(self, world: World, robot: RobotSettings) -> None:
        self._world = world
        self._geometry = robot.geometry
        self._sensors = robot.infrared.sensors
        half_m = robot.geometry.outline_length_m / 2, robot.geometry.outline_width_m / 2
        self._clearance_m = min(_CLEARANCE_M, math.hypot(*half_m) - min(half_m))
        self._in_sight_m = min(_IN_SIGHT_M, robot.infrared.far_m)
        reach_m = max(math.hypot(each.x_m, each.y_m) for each in self._sensors) + self._in_sight_m
        self._sight = RayCaster(world, reach_m)

    def draw(self, chance: random.Random, *, close: bool = False) -> Pose:
        """Return a random pose with 0.1 m clearance, less for a small robot, or 0.015 m if `close`.

        Raises config.settings.SettingsError if none is found.
        """
        clearance_m = _CLOSE_M if close else self._clearance_m
        world = self._world.settings
        width_m, height_m = world.size_m
        for _ in range(_TRIES):
            pose = Pose(chance.uniform(0.0, width_m), chance.uniform(0.0, height_m), chance.uniform(-math.pi, math.pi))
            if self._sees(pose) and world.clearance_m(pose, self._geometry) >= clearance_m:
                return pose
        what = "a round obstacle" if world.round_obstacles else "something"
        raise SettingsError(
            f"no place found where the robot stands free and sees {what}",
            where=f"world {world.name}",
            do="make room there, or let reposition_to and exam.start be starts",
        )

    def _sees(self, pose: Pose) -> bool:
        cos, sin = cos_sin(pose.heading_rad)
        posts = self._world.settings.round_obstacles
        self._sight.set_origin(pose.x_m, pose.y_m)
        for sensor in self._sensors:
            x_m = pose.x_m + sensor.x_m * cos - sensor.y_m * sin
            y_m = pose.y_m + sensor.x_m * sin + sensor.y_m * cos
            direction_rad = pose.heading_rad + math.radians(sensor.heading_deg)
            along_x, along_y = cos_sin(direction_rad)
            away_m = self._sight.distance_m(x_m, y_m, along_x, along_y, self._in_sight_m)
            at = (x_m + away_m * along_x, y_m + away_m * along_y)
            if away_m < self._in_sight_m and (
                not posts or any(math.dist(at, (post.x_m, post.y_m)) <= post.radius_m + _ON_A_POST_M for post in posts)
            ):
                return True
        return False
