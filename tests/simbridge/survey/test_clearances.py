"""Clearances of many positions at once are those of each alone."""

import random

import pytest

from hal.kurt2_settings import load_kurt2
from simbridge.robot.world import World
from simbridge.robot_simulation import Clearance
from simbridge.worlds.world_loading import load_world


@pytest.mark.parametrize("world", ["a", "two_objects"])
def test_clearances_are_those_of_single_positions(world: str) -> None:
    place, chance = World(load_world(world, load_kurt2())), random.Random(world)
    clearance = Clearance(place)
    width_m, height_m = place.settings.size_m
    positions = [(chance.uniform(0, width_m), chance.uniform(0, height_m)) for _ in range(200)]
    assert clearance.distances_m(positions) == [clearance.distances_m([position])[0] for position in positions]
    assert clearance.distances_m([]) == []
    name = place.settings.names[0]
    place.move_wall(name, 0.05, 0.0)
    assert clearance.distances_m(positions[:9]) == [clearance.distances_m([position])[0] for position in positions[:9]]
