"""Drives in pictures: the robot at both ends of its way, the way, where it asked, and where it collided."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, TypeVar

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patheffects import withStroke

from kurt2rt.experiments.lockstep.drive_row import DriveRow, Place
from simbridge.contracts.simulation import Pose, Position, SimulationFactory

TRAIL = "#1f6fb2"
ASKED = "#d1495b"
START = "#2e8540"
_COLLIDED = "#111111"
_END = "#0b3d6b"
_CARRIED_M = 0.5
"""A robot that is so far from where it was 0.2 s ago was set down elsewhere."""
_ARROW = {"arrowstyle": "-|>", "color": TRAIL, "mutation_scale": 13, "shrinkA": 0, "shrinkB": 0}
_LEGEND: dict[str, Any] = {"ncols": 4, "fontsize": "small", "frameon": False, "handlelength": 1.2, "columnspacing": 1.0}
_ARROWS_IN_A_ROW = 5
"""So many arrows stand on a straight way through the whole picture."""

PlaceT = TypeVar("PlaceT", bound=tuple[float, ...])


def draw_drive(axes: Axes, factory: SimulationFactory, drive: DriveRow) -> None:
    """Draw a world with a drive of results. Raises config.settings.SettingsError for an unknown world."""
    label = f"the robot, {drive.duration_s:.0f} s"
    draw_way(axes, factory, drive.world, drive.trail, drive.asked_at, drive.collided_at, label=label)


def draw_way(
    axes: Axes,
    factory: SimulationFactory,
    world: str,
    trail: Sequence[Pose],
    asked: Sequence[Place | Position] = (),
    collided: Sequence[Place | Position] = (),
    *,
    label: str = "the robot",
) -> None:
    """Draw a world, the way of a robot, in m and 0.2 s apart, and the places where it asked and collided.

    Raises config.settings.SettingsError for an unknown world.
    """
    factory.draw(axes, world)
    draw_trail(axes, trail, label)
    left_m, right_m = axes.get_xlim()
    for here, there in _arrows(trail, (right_m - left_m) / _ARROWS_IN_A_ROW):
        axes.annotate("", there, here, arrowprops=_ARROW, zorder=3)
    for poses, colour, name in ((trail[:1], START, "start"), (trail[-1:], _END, "end")):
        for pose in poses:
            factory.draw_robot(axes, pose, colour, name)
    draw_marks(axes, asked, collided)


def draw_marks(axes: Axes, asked: Sequence[Place | Position], collided: Sequence[Place | Position]) -> None:
    """Draw question marks where a robot asked, and crosses where it collided."""
    for places, marker, colour, name in ((asked, "$?$", ASKED, "asked"), (collided, "X", _COLLIDED, "collided")):
        if places:
            (marks,) = axes.plot(*columns(places), marker=marker, ms=10, color=colour, ls="none", zorder=6)
            marks.set_label(f"{name} ({len(places)})")
            marks.set_path_effects([withStroke(linewidth=2.5, foreground="white")])


def draw_trail(
    axes: Axes, trail: Sequence[PlaceT], label: str, *, colour: str = TRAIL, width: float = 1.0, zorder: float = 3
) -> None:
    """Draw the line of a way alone, with gaps at repositionings.

    Args:
        trail: places in m, 0.2 s apart.
        width: width of the line in points.
    """
    said: str | None = label
    for way in ways(trail):
        axes.plot(*columns(way), color=colour, linewidth=width, zorder=zorder, label=said)
        said = None


def _arrows(trail: Sequence[Pose], apart_m: float) -> Iterator[tuple[Place, Place]]:
    """Yield tail and head of each arrow along a way, in m."""
    gone_m = apart_m / 2
    for way in ways(trail):
        for here, there in pairwise(way):
            gone_m += math.dist(here[:2], there[:2])
            if gone_m >= apart_m:
                gone_m = 0.0
                yield here[:2], there[:2]


def ways(trail: Sequence[PlaceT]) -> list[list[PlaceT]]:
    """Return a trail in pieces, split where the robot was set down elsewhere."""
    pieces: list[list[PlaceT]] = []
    for place in trail:
        if not pieces or math.dist(pieces[-1][-1][:2], place[:2]) > _CARRIED_M:
            pieces.append([])
        pieces[-1].append(place)
    return pieces


def columns(places: Sequence[tuple[float, ...]]) -> tuple[list[float], list[float]]:
    """Return all x and all y of the places, in m, as two lists, as matplotlib draws them."""
    return [place[0] for place in places], [place[1] for place in places]


def legend_below(axes: Axes) -> None:
    """Draw the legend below the floor plan, where it hides no wall."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), **_LEGEND)


def panels_of(count: int, in_a_row: int, size: tuple[float, float]) -> tuple[Figure, list[Axes]]:
    """Return a figure with so many panels, at most `in_a_row` of them; `size`: of each, in inches."""
    wide = min(in_a_row, count)
    rows = math.ceil(count / wide)
    layout = ConstrainedLayoutEngine(h_pad=0.15, w_pad=0.1)
    figure = Figure(figsize=(size[0] * wide, size[1] * rows), layout=layout)
    panels = figure.subplots(rows, wide, squeeze=False).flatten().tolist()
    for unused in panels[count:]:
        unused.set_axis_off()
    return figure, panels[:count]
