import random

import pytest

from hal.robot_settings import load_robot
from hal.settings import SettingsError
from simbridge import free_poses
from simbridge.free_poses import FreePoses
from simbridge.obstacle_settings import RoundObstacleSettings
from simbridge.world import World
from simbridge.world_loading import load_world


def test_a_world_without_a_free_pose_in_sight_is_named_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(free_poses, "_TRIES", 200)
    one_object = load_world("one_object")
    (post,) = one_object.round_obstacles
    nook = RoundObstacleSettings(name=post.name, x_m=0.0, y_m=0.0, radius_m=0.002)  # in a corner, hardly to be seen
    world = one_object.model_copy(update={"round_obstacles": (nook,)})
    with pytest.raises(SettingsError) as caught:
        FreePoses(World(world), load_robot()).draw(random.Random(1))
    assert str(caught.value) == (
        f"world {world.name}: no place found where the robot stands free and sees a round obstacle; make room there, "
        "or let reposition_to and exam.start be starts"
    )
