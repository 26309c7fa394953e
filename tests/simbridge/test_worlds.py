import math
from pathlib import Path

import pytest
import shapely
import yaml

from config import CONFIG_DIR
from hal.settings import SettingsError
from simbridge.sight import Sight
from simbridge.world import World
from simbridge.world_settings import WorldSettings, load_world
from tests.simbridge.rig import ROBOT

NAMES = ("a", "b", "c")
PLAIN = {
    "name": "plain",
    "size_m": [3.0, 3.0],
    "infrared_rays": 1,
    "outline": [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]],
    "start_poses": [{"x_m": 1.5, "y_m": 1.5, "heading_deg": 0}],
}
BOW_TIE = [[0, 0], [3, 3], [3, 0], [0, 3], [0, 0]]
STAR = [[0.5, 0.2], [0.68, 0.74], [0.2, 0.41], [0.8, 0.41], [0.32, 0.74]]
BOARD = {"name": "board", "from_m": [1.5, 0.0], "to_m": [1.5, 1.5], "thickness_m": 0.05}


def left_clearances_m(world: WorldSettings, start: int) -> list[float]:
    """Distance to the wall at the left of each left sensor at a start pose."""
    pose = world.start_poses[start].pose
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    sight = Sight(World(world), 2.0)
    sight.look_from(pose.x_m, pose.y_m)
    return [
        sight.distance_m(
            pose.x_m + sensor.x_m * cos - sensor.y_m * sin,
            pose.y_m + sensor.x_m * sin + sensor.y_m * cos,
            -sin,
            cos,
            1.5,
        )
        for sensor in ROBOT.infrared.sensors
        if sensor.heading_deg == 90
    ]


@pytest.mark.parametrize("name", NAMES)
def test_every_start_has_its_wall_on_the_left_and_looks_along_it(name: str) -> None:
    world = load_world(name)
    assert len(world.start_poses) >= 8
    for start in range(len(world.start_poses)):
        clearances = left_clearances_m(world, start)
        assert all(0.145 <= clear_m <= 0.305 for clear_m in clearances), f"start_poses.{start}: {clearances}"
        assert max(clearances) - min(clearances) < 0.01


def test_the_training_ground_is_three_by_four_metres() -> None:
    world = load_world("a")
    assert world.size_m == (3.0, 4.0)
    assert 0.8 * 12 < shapely.Polygon(world.outline).area < 12


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (
            {"outline": [[0, 0], [3, 0], [3, 3], [0, 3]]},
            r"outline: .*not closed: .*\(0.0, 3.0\) must repeat .*\(0.0, 0.0\)",
        ),
        ({"outline": BOW_TIE}, r"outline: .*intersects or touches itself: Self-intersection\[1.5 1.5\]"),
        ({"outline": [[0, 0], [3, 0], [3, 0], [3, 3], [0, 3], [0, 0]]}, "outline: .*stands twice in a row"),
        ({"outline": [[0, 0], [3, 0], [3, 3], [3, 1], [0, 3], [0, 0]]}, r"outline: .*touches itself: .*\[3 1\]"),
        ({"size_m": [3.0, 4.0]}, "outline must span 0 to 4.0 in y"),
        ({"walls": [BOARD, BOARD]}, "two walls or obstacles share the name board"),
        ({"walls": [{**BOARD, "to_m": [1.5, 0.0]}]}, "walls.0: .*at least 0.01 m apart"),
        (
            {"polygon_obstacles": [{"name": "arrow", "corners": [[0.2, 0.2], [1, 0.5], [0.2, 1], [0.5, 0.5]]}]},
            "polygon_obstacles.0.corners: .*must be convex",
        ),
        ({"polygon_obstacles": [{"name": "star", "corners": STAR}]}, "polygon_obstacles.0.corners: .*must be convex"),
        (
            {"polygon_obstacles": [{"name": "line", "corners": [[0.2, 0.2], [0.5, 0.2], [0.9, 0.2]]}]},
            "polygon_obstacles.0.corners: .*must be convex",
        ),
        ({"start_poses": []}, "start_poses"),
        ({"start_poses": [{"x_m": 0.25, "y_m": 1.5, "heading_deg": 0}]}, "start_poses.0: the robot is 0.033 m"),
        ({"start_poses": [{"x_m": 5.0, "y_m": 1.5, "heading_deg": 0}]}, "start_poses.0: the robot is 0.000 m"),
        ({"walls": [{**BOARD, "to_m": [1.5, 1.4]}]}, "start_poses.0: the robot is 0.000 m"),
        (
            {"round_obstacles": [{"name": "post", "x_m": 1.5, "y_m": 1.7, "radius_m": 0.01}]},
            "start_poses.0: the robot is 0.025 m",
        ),
        (
            {"polygon_obstacles": [{"name": "chip", "corners": [[1.6, 1.5], [1.62, 1.5], [1.61, 1.52]]}]},
            "start_poses.0: the robot is 0.000 m",
        ),
        ({"infrared_rays": 2}, "infrared_rays"),
        ({"wals": []}, "wals: no such key"),
    ],
)
def test_a_world_that_cannot_be_is_refused_with_file_and_key(
    change: dict[str, object], complaint: str, tmp_path: Path
) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(yaml.safe_dump({**PLAIN, **change}), encoding="utf-8")
    with pytest.raises(SettingsError, match=rf"wrong\.yaml: .*{complaint}"):
        load_world(str(path))


def test_plain_is_a_world(tmp_path: Path) -> None:
    path = tmp_path / "plain.yaml"
    path.write_text(yaml.safe_dump(PLAIN), encoding="utf-8")
    assert load_world(str(path)).name == "plain"


def test_moving_a_wall_keeps_the_settings_true() -> None:
    world = World(load_world("a"))
    before = world.settings.walls[0]
    world.move_wall("tongue", 0.1, -0.2)
    after = world.settings.walls[0]
    assert after.from_m == pytest.approx((before.from_m[0] + 0.1, before.from_m[1] - 0.2))
    assert load_world("a").walls[0] == before


def test_every_shipped_world_loads() -> None:
    for path in (CONFIG_DIR / "worlds").glob("*.yaml"):
        assert load_world(path.stem).start_poses
