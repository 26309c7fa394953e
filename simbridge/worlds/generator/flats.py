"""Random flats as a robot's map holds them: rooms, doors and furniture in cells of 5 cm, with ragged walls."""

import math
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from simbridge.worlds.generator.seeded_random import SeededRandom
from simbridge.worlds.generator.starts import TURNING_M
from simbridge.worlds.geometry import rectangle
from simbridge.worlds.world_settings import WorldSettings

_CELL_M = 0.05
_LEAST_ROOM_M = 2.0
_WHOLE_ROOM_M = 3.6
"""A room that is shorter than this is not divided."""
_WALL_CELLS = 2
_RAGGED = 0.04
"""Fraction of the free cells next to a wall that the map takes for wall, as a scan with noise does."""
_LEAST_STARTS = 6

Cells = NDArray[np.bool_]
"""Free cells, (rows, columns), row 0 at the bottom."""
Area = tuple[int, int, int, int]
"""First column, first row, columns and rows."""


def flat(seed: int) -> WorldSettings:
    """Return the flat of a seed: 4 to 9 rooms behind doors of 0.8 to 1.1 m, each with up to three pieces of furniture.

    It is traced from its cells as a map of ROS's map_server is.
    """
    # Imported here, because only maps need the library that traces cells.
    from simbridge.worlds.map_server.starts import starts_beside_walls, turning_places
    from simbridge.worlds.map_server.world import floors_of_cells, world_of_floor

    name = f"flats-{seed}"
    attempt = 0
    while True:
        rng = SeededRandom(f"{name}, attempt {attempt}")
        cells = _draw(rng)
        floor = floors_of_cells(cells, _CELL_M)[0]
        places = turning_places(floor, TURNING_M)
        if places is not None and _joins_rooms(floor, places):
            starts = starts_beside_walls(floor, places)
            if len(starts) >= _LEAST_STARTS:
                return world_of_floor(Path(name), floor, starts)
        attempt += 1


def _joins_rooms(floor: shapely.Polygon, places: shapely.Polygon) -> bool:
    """Return whether the largest area in which the robot can turn is nearly all of them."""
    everywhere = shapely.buffer(floor, -TURNING_M, quad_segs=4)
    return bool(places.area >= 0.95 * everywhere.area)


def _draw(rng: SeededRandom) -> Cells:
    columns, rows = (round(rng.length_m(least_m, most_m) / _CELL_M) for least_m, most_m in ((6.0, 9.0), (5.0, 7.0)))
    cells = np.ones((rows, columns), dtype=np.bool_)
    for room in _divide((0, 0, columns, rows), cells, rng):
        for _ in range(rng.integer(4)):
            _furnish(room, cells, rng)
    return _roughen(cells, rng)


def _divide(area: Area, cells: Cells, rng: SeededRandom) -> list[Area]:
    """Divide an area by walls with a door each, and return its rooms."""
    column, row, columns, rows = area
    upright = columns >= rows
    along, across = (columns, rows) if upright else (rows, columns)
    least = round(_LEAST_ROOM_M / _CELL_M)
    if along * _CELL_M < _WHOLE_ROOM_M or along < 2 * least + _WALL_CELLS:
        return [area]
    wall = least + rng.integer(along - 2 * least - _WALL_CELLS + 1)
    door = round(rng.length_m(0.8, 1.1) / _CELL_M)
    # A door leaves a piece of wall at both sides, because the robot follows walls through it.
    begin = _WALL_CELLS + rng.integer(across - door - 2 * _WALL_CELLS + 1)
    solid = [place for place in range(across) if not begin <= place < begin + door]
    beyond = along - wall - _WALL_CELLS
    if upright:
        cells[np.ix_([row + place for place in solid], range(column + wall, column + wall + _WALL_CELLS))] = False
        halves = (column, row, wall, rows), (column + wall + _WALL_CELLS, row, beyond, rows)
    else:
        cells[np.ix_(range(row + wall, row + wall + _WALL_CELLS), [column + place for place in solid])] = False
        halves = (column, row, columns, wall), (column, row + wall + _WALL_CELLS, columns, beyond)
    return [room for half in halves for room in _divide(half, cells, rng)]


def _furnish(room: Area, cells: Cells, rng: SeededRandom) -> None:
    """Set one piece of furniture into a room, at a wall or anywhere."""
    column, row, columns, rows = room
    centre = (column + rng.integer(columns)) * _CELL_M, (row + rng.integer(rows)) * _CELL_M
    heading_rad = math.radians(rng.choice((0, 0, 90, 90, 30, 55)))
    piece = shapely.Polygon(rectangle(centre, rng.length_m(0.3, 1.4), rng.length_m(0.3, 0.7), heading_rad))
    middles = (np.arange(length) * _CELL_M + _CELL_M / 2 for length in reversed(cells.shape))
    cells[shapely.contains_xy(piece, *np.meshgrid(*middles))] = False


def _roughen(cells: Cells, rng: SeededRandom) -> Cells:
    """Return the cells with some of those next to a wall taken for wall."""
    padded = np.pad(cells, 1)
    next_to_wall = cells & ~(padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2])
    rough = cells.copy()
    for row, column in np.argwhere(next_to_wall).tolist():
        if rng.chance(_RAGGED):
            rough[row, column] = False
    return rough
