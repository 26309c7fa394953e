"""Worlds: the shipped ones, and the checks of their files."""

from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from simbridge.worlds.world_loading import load_world
from tests.simbridge.rig import ROBOT, Rig, box, left_clearances_m, refusal, room

NAMES = ("a", "b", "c")
PLAIN = {
    "name": "plain",
    "size_m": [3.0, 3.0],
    "infrared_rays": 1,
    "outline": [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]],
    "start_poses": [{"x_m": 1.5, "y_m": 1.5, "heading_deg": 0}],
}
BOW_TIE = [[0, 0], [3, 3], [3, 0], [0, 3], [0, 0]]
BAY = [[1.5, 2.1], [2.2, 2.1], [2.2, 2.9], [1.5, 2.9], [1.5, 2.85], [2.0, 2.85], [2.0, 2.15], [1.5, 2.15]]
STAR = [[0.5, 0.2], [0.68, 0.74], [0.2, 0.41], [0.8, 0.41], [0.32, 0.74]]
AHEAD = {"x_m": 1.5, "y_m": 1.5, "heading_deg": 0}
TWO_STARTS = [AHEAD, {**AHEAD, "x_m": 0.4}]
DIVIDER = {"name": "divider", "from_m": [0.8, 0.0], "to_m": [0.8, 3.0], "thickness_m": 0.02}
BOARD = {"name": "board", "from_m": [1.5, 0.0], "to_m": [1.5, 1.5], "thickness_m": 0.05}


def written(folder: Path, change: dict[str, object]) -> str:
    """Return the path of a file of the plain world with some keys changed."""
    path = folder / "plain.yaml"
    path.write_text(yaml.safe_dump({**PLAIN, **change}), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("name", NAMES)
def test_starts_look_along_a_left_wall(name: str) -> None:
    world = load_world(name)
    assert len(world.start_poses) >= 8
    for start in range(len(world.start_poses)):
        clearances = left_clearances_m(world, start)
        assert all(0.145 <= clear_m <= 0.305 for clear_m in clearances), f"start_poses.{start}: {clearances}"
        assert max(clearances) - min(clearances) < 0.01


def around(*corners: list[float]) -> dict[str, object]:
    return {"outline": [[0, 0], [3, 0], *corners]}


def with_box(name: str, *corners: list[float]) -> dict[str, object]:
    return {"polygon_obstacles": [{"name": name, "corners": corners}]}


def with_post(x_m: float, y_m: float, radius_m: float) -> dict[str, object]:
    return {"round_obstacles": [{"name": "post", "x_m": x_m, "y_m": y_m, "radius_m": radius_m}]}


@pytest.mark.parametrize(
    ("change", "fragments"),
    [
        (around([3, 3], [0, 3]), ("outline", "(0.0, 3.0)", "(0.0, 0.0)")),
        ({"outline": BOW_TIE}, ("outline", "[1.5 1.5]")),
        (around([3, 3], [3, 1], [0, 3], [0, 0]), ("outline", "[3 1]")),
        ({"size_m": [3.0, 4.0]}, ("outline", "4.0 in y")),
        ({"walls": [BOARD, BOARD]}, ("board",)),
        ({"walls": [{**BOARD, "to_m": [1.5, 0.0]}]}, ("walls.0", "0.01 m")),
        (with_box("star", *STAR), ("polygon_obstacles.0.corners",)),
        (with_post(3.2, 1.5, 0.2), ("post",)),
        ({"walls": [{**BOARD, "from_m": [-1, -0.1], "to_m": [4, -0.1]}]}, ("board",)),
        ({"start_poses": [AHEAD, {**AHEAD, "heading_deg": 90}, AHEAD]}, ("start_poses.0", "start_poses.2")),
        (
            {"start_poses": [{**AHEAD, "heading_deg": 180}, {**AHEAD, "heading_deg": -179.5}]},
            ("start_poses.0", "start_poses.1"),
        ),
        ({"walls": [DIVIDER], "start_poses": TWO_STARTS}, ("start_poses.1", "0.33 m")),
        ({"streets": [{"from_m": [1.5, 1.5], "to_m": [1.5, 2.9], "width_m": 0.8}]}, ("streets.0",)),
        ({"start_poses": []}, ("start_poses",)),
        ({"start_poses": [{**AHEAD, "x_m": 0.25}]}, ("start_poses.0", "0.033 m")),
        ({"walls": [{**BOARD, "to_m": [1.5, 1.4]}]}, ("start_poses.0", "0.000 m")),
        (with_post(1.5, 1.7, 0.01), ("start_poses.0", "0.025 m")),
        ({"infrared_rays": 2}, ("infrared_rays",)),
        ({"wals": []}, ("wals",)),
    ],
)
def test_load_world_wrong_file_names_file_and_key(
    change: dict[str, object], fragments: tuple[str, ...], tmp_path: Path
) -> None:
    message = refusal(written(tmp_path, change))
    assert message.startswith(str(tmp_path))
    assert [fragment for fragment in fragments if fragment not in message] == []


def test_concave_obstacle_lets_the_robot_in() -> None:
    with Rig(room(boxes=[box(*((x + 1.0, y - 0.5) for x, y in BAY))])) as rig:
        rig.run(0.5)
        assert ROBOT.infrared.distance_m(rig.reading("s11")) > 0.5
        rig.drive(20, 20, 6.0)
        assert rig.robot.collisions > 0
        assert rig.robot.pose.x_m == pytest.approx(3.0 - ROBOT.geometry.outline_length_m / 2, abs=0.01)


def test_load_world_loads_every_shipped_world() -> None:
    for path in (CONFIG_DIR / "worlds").glob("*.yaml"):
        assert load_world(path.stem).start_poses
