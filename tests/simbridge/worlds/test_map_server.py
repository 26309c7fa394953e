"""Maps of ROS's map_server as worlds."""

import itertools
import json
import math
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity
import yaml
from numpy.typing import NDArray
from PIL import Image

from simbridge.worlds.map_server.tracing import trace
from simbridge.worlds.map_server.world import MOST_WALLS, MapSettings, drivable_cells
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import WorldSettings
from tests.simbridge.rig import ROBOT, refusal

CELL_M = 0.05
FREE, UNKNOWN, OCCUPIED = 254, 205, 0
PLAIN = {
    "image": "flat.pgm",
    "resolution": CELL_M,
    "origin": [-10.0, -7.5, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
START = {"x_m": -8.9, "y_m": -5.5, "heading_deg": 90.0}
L_SHAPE = shapely.Polygon([(40, 30), (60, 30), (60, 34), (44, 34), (44, 50), (40, 50)])
FLAT = shapely.Polygon(
    [(10, 10), (90, 10), (90, 50), (70, 50), (70, 70), (10, 70)],
    [L_SHAPE.exterior, shapely.box(20, 57, 22, 60).exterior],
)
"""Room in cells with a corner cut out, an island that bends inwards, and a small one."""

Shades = NDArray[np.uint8]


def drawn(free: shapely.Geometry, width: int = 100, height: int = 80) -> Shades:
    """Return an image of the free area, unknown elsewhere, first row on top."""
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return np.where(shapely.contains_xy(free, x, y), FREE, UNKNOWN).astype(np.uint8)[::-1]


def write_p2(path: Path, shades: Shades) -> None:
    rows = "\n".join(" ".join(str(shade) for shade in row) for row in shades)
    path.write_text(f"P2\n# by hand\n{shades.shape[1]} {shades.shape[0]}\n255\n{rows}\n", encoding="ascii")


def write_p5(path: Path, shades: Shades) -> None:
    path.write_bytes(f"P5 {shades.shape[1]} {shades.shape[0]} 255\n".encode() + shades.tobytes())


def write_png(path: Path, shades: Shades) -> None:
    Image.fromarray(shades).save(path)


def write_yaml(path: Path, content: dict[str, object]) -> str:
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return str(path)


def cells(folder: Path, **change: object) -> object:
    """Return the drivable cells of a map whose image is in this folder."""
    settings = MapSettings.model_validate_json(json.dumps({**PLAIN, **change}))
    return drivable_cells(folder / "flat.yaml", settings).tolist()


def write_map(folder: Path, shades: Shades | None = None, **change: object) -> str:
    """Write a map's image and YAML file, and return the latter's path."""
    settings = {**PLAIN, **change}
    write_p5(folder / str(settings["image"]), drawn(FLAT) if shades is None else shades)
    return write_yaml(folder / "flat.yaml", settings)


def floor_of(world: WorldSettings) -> shapely.Polygon:
    assert isinstance(world.free_space, shapely.Polygon)
    return world.free_space


@pytest.mark.parametrize(("name", "write"), [("flat2.pgm", write_p2), ("flat5.pgm", write_p5), ("flat.png", write_png)])
def test_map_walls_along_the_grid_are_exact(name: str, write: Callable[[Path, Shades], None], tmp_path: Path) -> None:
    write(tmp_path / name, drawn(FLAT))
    world = load_world(write_yaml(tmp_path / "flat.yaml", {**PLAIN, "image": name}), ROBOT)
    assert world.name == "flat"
    assert world.size_m == pytest.approx((4.0, 3.0))
    wanted = shapely.affinity.scale(shapely.affinity.translate(FLAT, -10, -10), CELL_M, CELL_M, origin=(0, 0))
    assert floor_of(world).hausdorff_distance(wanted) == pytest.approx(0.0, abs=1e-9)
    assert [len(island.corners) for island in world.polygon_obstacles] in ([6, 4], [4, 6])
    assert world.infrared_rays == 1


@pytest.mark.parametrize("turn_deg", [28, 45])
def test_trace_slanted_walls_are_within_a_cell(turn_deg: int) -> None:
    floor = shapely.box(30, 30, 130, 90).difference(shapely.box(60, 50, 90, 70))
    floor = shapely.affinity.rotate(floor, turn_deg)
    (traced,) = trace(drawn(floor, 160, 160)[::-1] == FREE)
    walls = floor.boundary.difference(shapely.MultiPoint(shapely.get_coordinates(floor)).buffer(2.0))
    places = [line.interpolate(i / 50, normalized=True) for line in shapely.get_parts(walls) for i in range(51)]
    assert max(traced.boundary.distance(place) for place in places) < 1.05
    assert traced.symmetric_difference(floor).area <= 0.35 * floor.length
    assert traced.boundary.hausdorff_distance(floor.boundary) <= 1.5, "corners"
    assert len(shapely.get_coordinates(traced)) <= 70


def test_map_starts_are_at_a_left_wall_and_reproducible(tmp_path: Path) -> None:
    path = write_map(tmp_path)
    world = load_world(path, ROBOT)
    assert load_world(path, ROBOT) == world
    floor = floor_of(world)
    assert len(world.start_poses) == 8
    for start in world.start_poses:
        at = shapely.Point(start.x_m, start.y_m)
        away_m = floor.boundary.distance(at)
        assert 0.33 < away_m < 0.42
        left = shapely.affinity.translate(at, *(away_m * part for part in left_of(start.heading_deg)))
        assert floor.boundary.distance(left) < 1e-6
    for one, other in itertools.combinations(world.start_poses, 2):
        assert math.dist((one.x_m, one.y_m), (other.x_m, other.y_m)) >= 0.5


def left_of(heading_deg: float) -> tuple[float, float]:
    heading_rad = math.radians(heading_deg)
    return -math.sin(heading_rad), math.cos(heading_rad)


def test_map_of_several_rooms_uses_the_roomiest(tmp_path: Path) -> None:
    shades = drawn(FLAT, 300, 80)
    # Larger, but a corridor that the robot cannot turn in.
    shades[0:8, 5:295] = FREE
    shades[8:70, 100:110] = FREE
    assert load_world(write_map(tmp_path, shades), ROBOT).size_m == pytest.approx((4.0, 3.0))


def world_on(folder: Path, **change: object) -> str:
    return write_yaml(folder / "mine.yaml", {"map": "flat.yaml", "start_poses": [START], **change})


def test_world_on_map_starts_are_in_the_maps_frame(tmp_path: Path) -> None:
    write_map(tmp_path)
    world = load_world(world_on(tmp_path, infrared_rays=3), ROBOT)
    assert (world.name, world.infrared_rays) == ("mine", 3)
    (start,) = world.start_poses
    # The room begins 10 cells right of and above the map's lower left corner, (-10, -7.5).
    assert (start.x_m, start.y_m, start.heading_deg) == pytest.approx((0.6, 1.5, 90.0))


def test_world_on_map_rotated_origin_turns_the_starts(tmp_path: Path) -> None:
    write_map(tmp_path, origin=[2.0, 1.0, math.pi / 2])
    start = {"x_m": 2.0 - 2.0, "y_m": 1.0 + 1.1, "heading_deg": 180.0}
    world = load_world(world_on(tmp_path, start_poses=[start]), ROBOT)
    (found,) = world.start_poses
    assert (found.x_m, found.y_m, found.heading_deg) == pytest.approx((0.6, 1.5, 90.0))


@pytest.mark.parametrize(
    ("mode", "negate", "shades", "drivable"),
    [
        ("trinary", 0, [254, 206, 205, 100, 0], [True, True, False, False, False]),
        ("trinary", 1, [0, 49, 50, 100, 254], [True, True, False, False, False]),
        ("trinary", False, [254, 205, 0], [True, False, False]),
        ("scale", 0, [254, 205, 160, 120, 0], [True, True, True, False, False]),
        ("raw", 0, [0, 49, 50, 100, 101, 255], [True, True, False, False, False, False]),
    ],
)
def test_drivable_cells_follow_the_modes(
    mode: str, negate: object, shades: list[int], drivable: list[bool], tmp_path: Path
) -> None:
    write_p5(tmp_path / "flat.pgm", np.array([shades], dtype=np.uint8))
    assert cells(tmp_path, mode=mode, negate=negate) == [drivable]


@pytest.mark.parametrize("around", ["saved as unknown", "transparent white", "transparent, negated"])
def test_map_of_nav2_is_the_room_alone(around: str, tmp_path: Path) -> None:
    room = drawn(shapely.box(20, 10, 80, 70)) == FREE
    colour, opacity = {"saved as unknown": (UNKNOWN, 255), "transparent white": (255, 0)}.get(around, (0, 0))
    negate = int(around.endswith("negated"))
    cells_of = np.where(room, 255 - FREE if negate else FREE, colour).astype(np.uint8)
    alpha = np.where(room, 255, opacity).astype(np.uint8)
    if opacity == 255:
        write_p5(tmp_path / "flat.pgm", cells_of)
    else:
        Image.merge("LA", [Image.fromarray(each) for each in (cells_of, alpha)]).save(tmp_path / "flat.png")
    image = "flat.pgm" if opacity == 255 else "flat.png"
    # Opacity counts as brightness also in a negated map, so that its free cells are a quarter occupied.
    map_saver = {**PLAIN, "image": image, "mode": "trinary", "free_thresh": 0.3 if negate else 0.25, "negate": negate}
    world = load_world(write_yaml(tmp_path / "flat.yaml", map_saver), ROBOT)
    assert floor_of(world).area == pytest.approx(9.0)
    assert all(floor_of(world).contains(shapely.Point(start.x_m, start.y_m)) for start in world.start_poses)


def test_map_file_of_other_programs_is_read(tmp_path: Path) -> None:
    write_p5(tmp_path / "flat.pgm", drawn(FLAT))
    (tmp_path / "flat.yml").write_text(
        "Image: flat.pgm\nresolution: 5e-2\norigin: [-1e1, -7.5e0, 0.0]\nnegate: 0\noccupied_thresh: 65e-2\n"
        "free_thresh: 0.196\nfloor: 2\nnodes: {door: [7e2, 1]}\n",
        encoding="utf-8",
    )
    assert load_world(str(tmp_path / "flat.yml"), ROBOT) == load_world(write_map(tmp_path), ROBOT)


def test_drivable_cells_of_colours_and_transparency(tmp_path: Path) -> None:
    colours = np.array([[[254, 254, 254, 255], [255, 255, 150, 255], [160, 160, 160, 255], [160, 160, 160, 128]]])
    Image.fromarray(colours.astype(np.uint8)).save(tmp_path / "flat.png")
    for mode, wanted in (("trinary", [True, True, False, False]), ("scale", [True, True, True, False])):
        assert cells(tmp_path, image="flat.png", mode=mode) == [wanted]


def test_drivable_cells_of_16_bits_and_a_palette(tmp_path: Path) -> None:
    Image.fromarray(np.array([[65535, 52685, 0]], dtype=np.uint16)).save(tmp_path / "flat.png")
    assert cells(tmp_path, image="flat.png") == [[True, False, False]]
    Image.fromarray(np.array([[255, 205, 0]], dtype=np.uint8)).convert("P").save(tmp_path / "flat.png")
    assert cells(tmp_path, image="flat.png") == [[True, False, False]]


def test_trace_separates_cells_that_touch_at_a_corner() -> None:
    free = np.zeros((40, 40), dtype=np.bool_)
    free[2:20, 2:20] = free[20:38, 20:38] = True
    free[8:12, 8:12] = free[12:14, 12:14] = False
    traced = trace(free)
    assert all(polygon.is_valid for polygon in traced)
    assert sum(polygon.area for polygon in traced) == pytest.approx(free.sum(), rel=0.01)


@pytest.mark.parametrize(
    ("change", "key", "fragment"),
    [
        ({"image": "none.pgm"}, "image", "none.pgm"),
        ({"resolution": 0.0}, "resolution", "0"),
        ({"origin": [0.0, 0.0]}, "origin", ""),
        ({"free_thresh": 0.7}, "", "0.65"),
        ({"mode": "cubic"}, "mode", "'trinary', 'scale' or 'raw'"),
        ({"negate": 1}, "image", "0.67 m"),
        ({"resolution": 0.001}, "image", "0.67 m"),
        ({"image": "."}, "image", ""),
        ({"image": "fifo.pgm"}, "image", "fifo.pgm"),
        ({"image": "junk.pgm"}, "image", "junk.pgm"),
        ({"image": "cut.pgm"}, "image", "cut.pgm"),
        ({"image": "huge.pgm"}, "image", "10000 x 10000"),
    ],
)
def test_map_wrong_file_names_file_and_key(change: dict[str, object], key: str, fragment: str, tmp_path: Path) -> None:
    write_map(tmp_path)
    (tmp_path / "junk.pgm").write_bytes(b"P5 this is not")
    (tmp_path / "cut.pgm").write_bytes(b"P5 100 80 255\n" + bytes(100))
    os.mkfifo(tmp_path / "fifo.pgm")
    (tmp_path / "huge.pgm").write_bytes(b"P5 10000 10000 255\n")
    path = write_yaml(tmp_path / "flat.yaml", {**PLAIN, **change})
    message = refusal(path)
    assert message.startswith(f"{path}: {key}")
    assert fragment in message


def test_map_too_wide_is_refused(tmp_path: Path) -> None:
    path = write_map(tmp_path, np.full((300, 300), FREE, dtype=np.uint8), resolution=0.8)
    message = refusal(path)
    assert message.startswith(f"{path}: resolution: ")
    assert "240 m x 240 m" in message


@pytest.mark.parametrize(
    ("side", "occupied", "limit"), [(800, 0.3, 500_000), (400, 0.05, 5_000), (370, 0.01, MOST_WALLS)]
)
def test_map_of_specks_is_refused(side: int, occupied: float, limit: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    path = write_map(tmp_path, np.where(rng.random((side, side)) < occupied, OCCUPIED, FREE).astype(np.uint8))
    message = refusal(path)
    assert message.startswith(f"{path}: image: ")
    assert f"allowed {limit})" in message


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"map": "none.yaml"}, "map"),
        ({"start_poses": []}, "start_poses"),
        ({"start_poses": [START, START]}, ""),
        ({"map": "mine.yaml"}, "image"),
        ({"start_poses": [{"x_m": -7.8, "y_m": -5.9, "heading_deg": 0.0}]}, "start_poses.0"),
        ({"size_m": [1, 1]}, "size_m"),
    ],
)
def test_world_on_map_wrong_file_names_file_and_key(change: dict[str, object], key: str, tmp_path: Path) -> None:
    write_map(tmp_path)
    path = world_on(tmp_path, **change)
    assert refusal(path).startswith(f"{path}: {key}")


def test_map_ragged_slit_is_skipped(tmp_path: Path) -> None:
    shades = np.full((2600, 100), OCCUPIED, dtype=np.uint8)
    shades[10:2570, 5] = FREE  # larger than what is left of the room where the robot turns
    shades[10:2570:2, 6] = shades[11:2570:2, 4] = FREE
    shades[20:100, 15:95] = FREE
    world = load_world(write_map(tmp_path, shades), ROBOT)
    assert floor_of(world).area == pytest.approx(16.0)
