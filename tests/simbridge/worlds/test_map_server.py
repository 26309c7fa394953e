"""Maps of ROS's map_server as worlds."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity
import yaml
from numpy.typing import NDArray
from PIL import Image

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


def write_p5(path: Path, shades: Shades) -> None:
    path.write_bytes(f"P5 {shades.shape[1]} {shades.shape[0]} 255\n".encode() + shades.tobytes())


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


def world_on(folder: Path, **change: object) -> str:
    return write_yaml(folder / "mine.yaml", {"map": "flat.yaml", "start_poses": [START], **change})


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
