"""Trails of robots in figures."""

import math
from collections.abc import Sequence
from typing import TypeVar

from matplotlib.axes import Axes

from simbridge.contracts.simulation import SimulationFactory

TRAIL = "#1f6fb2"
ASKED = "#d1495b"
_CARRIED_M = 0.5
"""A robot that is so far from where it was 0.2 s ago was set down elsewhere."""

PlaceT = TypeVar("PlaceT", bound=tuple[float, float])


def draw_trail(
    axes: Axes,
    trail: Sequence[tuple[float, float]],
    label: str,
    *,
    colour: str = TRAIL,
    width: float = 1.0,
    zorder: float = 3,
) -> None:
    """Draw a line with gaps at repositionings.

    Args:
        trail: points in m, 0.2 s apart.
        width: width of the line in points.
    """
    said: str | None = label
    for way in ways(trail):
        axes.plot(*columns(way), color=colour, linewidth=width, zorder=zorder, label=said)
        said = None


def ways(trail: Sequence[PlaceT]) -> list[list[PlaceT]]:
    """Return a trail in pieces, split where the robot was set down elsewhere."""
    pieces: list[list[PlaceT]] = []
    for place in trail:
        if not pieces or math.dist(pieces[-1][-1], place) > _CARRIED_M:
            pieces.append([])
        pieces[-1].append(place)
    return pieces


def columns(places: Sequence[tuple[float, float]]) -> tuple[list[float], list[float]]:
    """Return all x and all y of the places, in m, as two lists, as matplotlib draws them."""
    return [x for x, _ in places], [y for _, y in places]


def draw_drive(
    axes: Axes,
    factory: SimulationFactory,
    world: str,
    trail: Sequence[tuple[float, float]],
    asked: Sequence[tuple[float, float]],
    *,
    label: str = "the robot",
    width: float = 1.0,
) -> None:
    """Draw a world with a trail and the places of unknown situations, in m; `width`: of the line in points.

    Raises config.settings.SettingsError for an unknown world.
    """
    factory.draw(axes, world)
    draw_trail(axes, trail, label, width=width)
    if asked:
        told = f"situation unknown ({len(asked)})"
        axes.plot(*columns(asked), "o", color=ASKED, markersize=4, zorder=4, label=told)


def legend_below(axes: Axes, columns: int = 3) -> None:
    """Draw the legend below the floor plan, in so many columns, where it hides no wall."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=columns, fontsize="small", frameon=False)
