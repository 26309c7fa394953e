"""Trails of robots in figures."""

import math
from collections.abc import Sequence
from typing import TypeVar

from matplotlib.axes import Axes

TRAIL = "#1f6fb2"
ASKED = "#d1495b"

PlaceT = TypeVar("PlaceT", bound=tuple[float, float])


def draw_trail(
    axes: Axes,
    trail: Sequence[tuple[float, float]],
    label: str,
    *,
    carried_m: float,
    colour: str = TRAIL,
    width: float = 1.0,
    zorder: float = 3,
) -> None:
    """Draw a line with gaps at repositionings.

    Args:
        trail: points in m.
        carried_m: least distance between two points of a gap.
        width: width of the line in points.
    """
    said: str | None = label
    for way in ways(trail, carried_m):
        axes.plot(*columns(way), color=colour, linewidth=width, zorder=zorder, label=said)
        said = None


def ways(trail: Sequence[PlaceT], carried_m: float) -> list[list[PlaceT]]:
    """Return a trail in pieces, split where two points are farther apart than `carried_m`, in m."""
    pieces: list[list[PlaceT]] = []
    for place in trail:
        if not pieces or math.dist(pieces[-1][-1], place) > carried_m:
            pieces.append([])
        pieces[-1].append(place)
    return pieces


def columns(places: Sequence[tuple[float, float]]) -> tuple[list[float], list[float]]:
    """Return all x and all y of the places, in m, as two lists."""
    return [x for x, _ in places], [y for _, y in places]
