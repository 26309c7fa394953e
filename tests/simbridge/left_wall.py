"""How a robot at a start pose stands to the wall on its left."""

import math

from simbridge.sight import RayCaster
from simbridge.world import World
from simbridge.world_settings import WorldSettings
from tests.simbridge.rig import ROBOT

LEFT = [sensor for sensor in ROBOT.infrared.sensors if sensor.heading_deg == 90]


def left_clearances_m(world: WorldSettings, start: int) -> list[float]:
    """Distance to the wall at the left of each left sensor at a start pose."""
    pose = world.start_poses[start].pose
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    sight = RayCaster(World(world), 2.0)
    sight.set_origin(pose.x_m, pose.y_m)
    return [
        sight.distance_m(
            pose.x_m + sensor.x_m * cos - sensor.y_m * sin,
            pose.y_m + sensor.x_m * sin + sensor.y_m * cos,
            -sin,
            cos,
            1.5,
        )
        for sensor in LEFT
    ]
