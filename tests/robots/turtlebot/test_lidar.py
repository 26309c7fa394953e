"""Simulated lidar: as far as the simulator's ray caster sees, with its period, limits and noise."""

import math
import random

import numpy as np
import pytest

from hal.numerics import cos_sin
from kurt2rt.robots.turtlebot.lidar import distances_m
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.world import World
from simbridge.worlds.world_loading import load_world
from tests.robots.turtlebot.rig import SETTINGS


@pytest.mark.parametrize("name", ["turtlebot/a", "turtlebot/b", "turtlebot/c", "turtlebot/post"])
def test_distances_are_those_of_the_ray_caster(name: str) -> None:
    settings, chance = load_world(name, SETTINGS), random.Random(name)
    caster = RayCaster(World(settings), 10.0)
    for start in settings.start_poses:
        pose = start.pose
        headings = [chance.uniform(-math.pi, math.pi) for _ in range(40)]
        caster.set_origin(pose.x_m, pose.y_m)
        expected = [caster.distance_m(pose.x_m, pose.y_m, *cos_sin(each), 10.0) for each in headings]
        assert distances_m(settings, pose, np.array(headings)) == pytest.approx(expected, abs=1e-9)
