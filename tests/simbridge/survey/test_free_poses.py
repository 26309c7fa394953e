"""Free poses, and the clearance to the nearest face."""

import random

import pytest

from config.settings import SettingsError
from simbridge.robot.world import World
from simbridge.survey import free_poses
from simbridge.survey.free_poses import FreePoses
from simbridge.worlds.world_loading import load_world
from tests.simbridge.rig import ROBOT, post


def test_free_poses_without_any_name_the_world(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(free_poses, "_TRIES", 200)
    nook = post(0.0, 0.0, 0.002)  # in a corner, hardly visible
    world = load_world("one_object").model_copy(update={"round_obstacles": (nook,)})
    with pytest.raises(SettingsError, match=world.name):
        FreePoses(World(world), ROBOT).draw(random.Random(1))
