"""Walls between cells: contours by contourpy, straightened by shapely."""

from collections.abc import Iterator
from itertools import pairwise
from typing import cast

import contourpy
import numpy as np
import shapely
from numpy.typing import NDArray

from simbridge.worlds.geometry import polygons_of

_TOLERANCE_CELLS = 0.7
"""Tolerance of straightening. A slanted wall is a staircase of cells. With half a cell many steps remain, up to 169 for
eight walls; from 0.71 on, a single cell loses a corner. The walls' distance is the same.
"""

_MOST_SIDES = 500_000
_MOST_OUTLINES = 5_000
_MOST_BENDS = 50_000
"""Limit of bends; time grows with their square, and these take a few seconds."""

Ring = NDArray[np.float64]
"""Corners, shape (n, 2), the first not repeated."""


class TooRaggedError(ValueError):
    """Cells too ragged to be rooms: straightening their outlines would take minutes."""


def trace(free: NDArray[np.bool_]) -> list[shapely.Polygon]:
    """Return the free area of a cell map, shape (rows, columns), as polygons with holes.

    Lengths are in cells; (0, 0) is the outer corner of cell [0, 0]. Walls parallel to the grid lie at the cells' edges,
    others within one cell of them, 0.2 on average. Raises TooRaggedError.
    """
    sides = np.count_nonzero(free[1:] != free[:-1]) + np.count_nonzero(free[:, 1:] != free[:, :-1])
    if sides > _MOST_SIDES:
        raise TooRaggedError(f"too many sides between free and other cells (got {sides}, allowed {_MOST_SIDES})")
    # A margin of occupied cells closes areas that reach the edge of the map.
    padded = np.pad(free, 1).astype(np.float64)
    generator = contourpy.contour_generator(z=padded, fill_type=contourpy.FillType.OuterOffset)
    # Level 0.5 passes halfway between the centres of a free and an occupied cell.
    areas, offsets = cast(tuple[list[Ring], list[NDArray[np.uint32]]], generator.filled(0.5, 2.0))
    outlines = sum(len(begins) - 1 for begins in offsets)
    if outlines > _MOST_OUTLINES:
        raise TooRaggedError(f"too many areas and islands (got {outlines}, allowed {_MOST_OUTLINES})")
    # Centres lie at whole numbers, and the margin is one cell wide. Each ring comes with its first point repeated.
    found = [
        [_outline(points[begin : end - 1] - 0.5) for begin, end in pairwise(begins)]
        for points, begins in zip(areas, offsets, strict=True)
    ]
    bends = sum(len(ring) for rings in found for ring in rings)
    if bends > _MOST_BENDS:
        raise TooRaggedError(f"too many bends (got {bends}, allowed {_MOST_BENDS})")
    return [polygon for rings in found for polygon in _straightened(rings)]


def _straightened(rings: list[Ring]) -> Iterator[shapely.Polygon]:
    polygon = _polygon(rings)
    # An outline may touch itself at a corner that two cells share, now that corners are restored.
    for part in polygons_of(shapely.make_valid(polygon, method="structure", keep_collapsed=False)):
        yield from polygons_of(part.simplify(_TOLERANCE_CELLS, preserve_topology=True))


def _polygon(rings: list[Ring]) -> shapely.Polygon:
    # Start at the leftmost corner, because straightening always keeps the first point.
    rolled = [np.roll(ring, -int(np.lexsort((ring[:, 1], ring[:, 0]))[0]), axis=0) for ring in rings]
    return shapely.Polygon(rolled[0], rolled[1:])


def _outline(contour: Ring) -> Ring:
    """Return the corners of a contour, which passes through the middle of each side between two cells.

    The contour cuts the cells' corners. Corners of walls are restored. Those of stairs, one side long and turning to
    alternating sides, stay cut, because they stand for a slanted wall.
    """
    way = np.roll(contour, -1, axis=0) - contour
    is_cut = np.all(np.abs(way) == 0.5, axis=1)
    before, after = contour[is_cut], np.roll(contour, -1, axis=0)[is_cut]
    lies_level = (before[:, 1] % 1.0 == 0.0)[:, None]  # the side that is left at this corner
    corners = np.where(lies_level, _joined(after, before), _joined(before, after))
    to_next = np.roll(corners, -1, axis=0) - corners
    from_last = np.roll(to_next, 1, axis=0)
    turn = np.sign(from_last[:, 0] * to_next[:, 1] - from_last[:, 1] * to_next[:, 0])
    steps_up = (np.abs(to_next).sum(axis=1) == 1.0) & (turn != np.roll(turn, -1))
    is_stair = (steps_up | np.roll(steps_up, 1))[:, None]
    points: Ring = np.stack([np.where(is_stair, before, corners), np.where(is_stair, after, corners)], axis=1)
    return _without_points_on_lines(points.reshape(-1, 2))


def _joined(x_of: Ring, y_of: Ring) -> Ring:
    return np.stack([x_of[:, 0], y_of[:, 1]], axis=1)


def _without_points_on_lines(ring: Ring) -> Ring:
    """Return the ring without points on straight lines; coordinates are multiples of 0.5, so comparisons are exact."""
    differs: NDArray[np.bool_] = np.any(ring != np.roll(ring, 1, axis=0), axis=1)
    ring = ring[differs]
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    bends: NDArray[np.bool_] = before[:, 0] * after[:, 1] != before[:, 1] * after[:, 0]
    return ring[bends]
