"""Drives in their worlds, in the panels of a figure."""

import math
from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.platform.drive_picture import END, START, Place, draw_arrows, draw_marks, draw_robot, draw_trail
from kurt2rt.platform.save_figure import ShownFigure
from simbridge.contracts.simulation import Pose, SimulationFactory

_LEGEND: dict[str, Any] = {"ncols": 4, "fontsize": "small", "frameon": False, "handlelength": 1.2, "columnspacing": 1.0}
_ARROWS_IN_A_ROW = 5
"""So many arrows stand on a straight way through the whole picture."""


def draw_drive(axes: Axes, factory: SimulationFactory, drive: DriveRow) -> None:
    """Draw a world with a drive of results. Raises config.settings.SettingsError for an unknown world."""
    label = f"the robot, {drive.duration_s:.0f} s"
    draw_way(axes, factory, drive.world, drive.trail, drive.asked_at, drive.collided_at, label=label)


def draw_way(
    axes: Axes,
    factory: SimulationFactory,
    world: str,
    trail: Sequence[Pose],
    asked: Sequence[Place] = (),
    collided: Sequence[Place] = (),
    *,
    label: str = "the robot",
) -> None:
    """Draw a world, the way of a robot, in m and 0.2 s apart, and the places where it asked and collided.

    Raises config.settings.SettingsError for an unknown world.
    """
    factory.draw(axes, world)
    draw_trail(axes, trail, label)
    left_m, right_m = axes.get_xlim()
    draw_arrows(axes, trail, (right_m - left_m) / _ARROWS_IN_A_ROW)
    for poses, colour, name in ((trail[:1], START, "start"), (trail[-1:], END, "end")):
        for pose in poses:
            draw_robot(axes, pose, factory.settings.geometry.outline_m, colour, name)
    draw_marks(axes, asked, collided)


def legend_below(axes: Axes) -> None:
    """Draw the legend below the floor plan, where it hides no wall."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), **_LEGEND)


def panels_of(count: int, in_a_row: int, size: tuple[float, float]) -> tuple[Figure, list[Axes]]:
    """Return a figure with so many panels, at most `in_a_row` of them; `size`: of each, in inches."""
    wide = min(in_a_row, count)
    rows = math.ceil(count / wide)
    layout = ConstrainedLayoutEngine(h_pad=0.15, w_pad=0.1)
    figure = ShownFigure(figsize=(size[0] * wide, size[1] * rows), layout=layout)
    panels = figure.subplots(rows, wide, squeeze=False).flatten().tolist()
    for unused in panels[count:]:
        unused.set_axis_off()
    return figure, panels[:count]
