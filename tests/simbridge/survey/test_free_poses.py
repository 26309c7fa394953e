"""Free poses, and the clearance to the nearest face."""

import math
import random

import pytest

from config.settings import SettingsError
from simbridge.contracts.simulation import Pose
from simbridge.robot.world import World
from simbridge.robot_simulation import Clearance
from simbridge.survey import free_poses
from simbridge.survey.free_poses import FreePoses
from simbridge.worlds.world_loading import load_world
from tests.simbridge.rig import ROBOT, post

FARTHEST_SENSOR_M = max(math.hypot(sensor.x_m, sensor.y_m) for sensor in ROBOT.infrared.sensors)


def poses(world: str, count: int = 12, *, close: bool = False) -> list[Pose]:
    free = FreePoses(World(load_world(world)), ROBOT)
    chance = random.Random(1)
    return [free.draw(chance, close=close) for _ in range(count)]


def test_free_poses_see_the_post_from_all_sides() -> None:
    world = load_world("one_object")
    found = poses("one_object")
    assert all(clear_m >= 0.1 for clear_m in world.clearances_m(found, ROBOT.geometry))
    (target,) = world.round_obstacles
    away_m = [math.dist(pose[:2], (target.x_m, target.y_m)) for pose in found]
    assert all(away < target.radius_m + 0.45 + FARTHEST_SENSOR_M for away in away_m)
    assert len({int(2 * math.atan2(pose.y_m - target.y_m, pose.x_m - target.x_m)) for pose in found}) > 4
    assert len({round(pose.heading_rad) for pose in found}) > 3


def test_free_poses_close_touch_nothing() -> None:
    clear_m = load_world("a").clearances_m(poses("a", 40, close=True), ROBOT.geometry)
    assert min(clear_m) >= 0.015
    assert sum(each < 0.1 for each in clear_m) > 5


@pytest.mark.parametrize(
    ("world", "position", "away_m"),
    [
        ("a", (0.3, 3.0), 0.3),
        ("a", (0.6, 1.5), 0.37),  # to the tongue, which is 6 cm thick
        ("a", (0.6, 1.9), 0.0),  # within it
        ("one_object", (2.2, 2.7), 0.46),
    ],
)
def test_clearance_is_the_distance_to_the_nearest_face(
    world: str, position: tuple[float, float], away_m: float
) -> None:
    assert Clearance(World(load_world(world))).distances_m([position]) == pytest.approx([away_m], abs=1e-9)


def test_clearance_follows_a_moved_wall() -> None:
    world = World(load_world("a"))
    nearest = Clearance(world)
    (before_m,) = nearest.distances_m([(0.6, 1.5)])
    world.move_wall("tongue", 0.0, 0.2)
    assert nearest.distances_m([(0.6, 1.5)]) == pytest.approx([before_m + 0.2])


def test_free_poses_without_any_name_the_world(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(free_poses, "_TRIES", 200)
    nook = post(0.0, 0.0, 0.002)  # in a corner, hardly visible
    world = load_world("one_object").model_copy(update={"round_obstacles": (nook,)})
    with pytest.raises(SettingsError, match=world.name):
        FreePoses(World(world), ROBOT).draw(random.Random(1))
