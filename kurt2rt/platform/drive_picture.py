"""Drives in pictures: the robot to scale, its way with its direction, where it asked, and where it collided."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke

TRAIL = "#1f6fb2"
ASKED = "#d1495b"
START = "#2e8540"
END = "#0b3d6b"
_COLLIDED = "#111111"
_CARRIED_M = 0.5
"""A robot that is so far from where it was 0.2 s ago was set down elsewhere."""
_MOST_ARROWS = 50

Place = tuple[float, ...]
"""x and y in m; of a pose also the heading in rad, counter-clockwise from x."""


def draw_robot(axes: Axes, pose: Place, outline_m: tuple[float, float], colour: str, label: str = "") -> None:
    """Draw a body of this length and width to scale in m, with a wedge that points ahead; `label`: of the legend."""
    x_m, y_m, heading_rad = pose
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    onto = np.array([[cos, sin], [-sin, cos]]) * np.array([outline_m]).T
    box = np.array([(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)]) @ onto + (x_m, y_m)
    wedge = np.array([(0.42, 0.0), (0.12, 0.25), (0.12, -0.25)]) @ onto + (x_m, y_m)
    axes.add_patch(Polygon(box, facecolor=colour, alpha=0.3, linewidth=0.0, zorder=4, label=label))
    axes.add_patch(Polygon(box, fill=False, edgecolor=colour, linewidth=1.6, zorder=5))
    axes.add_patch(Polygon(wedge, facecolor=colour, linewidth=0.0, zorder=5))


def draw_trail(
    axes: Axes, trail: Sequence[Place], label: str, *, colour: str = TRAIL, width: float = 1.0, zorder: float = 3
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


def draw_arrows(axes: Axes, trail: Sequence[Place], apart_m: float, colour: str = TRAIL) -> None:
    """Draw arrows along a way, each `apart_m` after the one before, or more if they would be too many."""
    look = {"arrowstyle": "-|>", "color": colour, "mutation_scale": 13, "shrinkA": 0, "shrinkB": 0}
    steps = [each for way in ways(trail) for each in pairwise(way)]
    lengths_m = [math.dist(here[:2], there[:2]) for here, there in steps]
    apart_m = max(apart_m, sum(lengths_m) / _MOST_ARROWS)
    gone_m = apart_m / 2
    for (here, there), length_m in zip(steps, lengths_m, strict=True):
        gone_m += length_m
        if gone_m >= apart_m:
            gone_m = 0.0
            axes.annotate("", (there[0], there[1]), (here[0], here[1]), arrowprops=look, zorder=3)


def draw_marks(axes: Axes, asked: Sequence[Place], collided: Sequence[Place]) -> None:
    """Draw question marks where a robot asked, and crosses where it collided."""
    for places, marker, colour, name in ((asked, "$?$", ASKED, "asked"), (collided, "X", _COLLIDED, "collided")):
        if places:
            (marks,) = axes.plot(*columns(places), marker=marker, ms=10, color=colour, ls="none", zorder=6)
            marks.set_label(f"{name} ({len(places)})")
            marks.set_path_effects([withStroke(linewidth=2.5, foreground="white")])


def ways(trail: Sequence[Place]) -> list[list[Place]]:
    """Return a trail in pieces, split where the robot was set down elsewhere."""
    pieces: list[list[Place]] = []
    for place in trail:
        if not pieces or math.dist(pieces[-1][-1][:2], place[:2]) > _CARRIED_M:
            pieces.append([])
        pieces[-1].append(place)
    return pieces


def columns(places: Sequence[Place]) -> tuple[list[float], list[float]]:
    """Return all x and all y of the places, in m, as two lists, as matplotlib draws them."""
    return [place[0] for place in places], [place[1] for place in places]
