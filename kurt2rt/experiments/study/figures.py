"""Figures in files, in the style that all of them share, and the picture of a drive."""

import math
from pathlib import Path
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from kurt2rt.experiments.lockstep import trails
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.trails import columns
from simbridge.contracts.simulation import SimulationFactory

_COLLIDED = "#111111"
START = "#2e8540"
_DPI = 130


class SavedFigure(NamedTuple):
    """Figure of a report: its PNG file, and the title and caption printed with it."""

    path: Path
    title: str
    caption: str


def save(figure: Figure, path: Path) -> None:
    """Save a figure as a PNG whose bytes depend on its content only. Raises OSError."""
    figure.savefig(path, dpi=_DPI, metadata={"Software": None})


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


def draw_drive(axes: Axes, factory: SimulationFactory, drive: DriveRow, width: float = 0.9) -> None:
    """Draw the world and the trail of a drive, with its start, unknown situations and collisions.

    `width`: of the trail's line, in points of 0.35 mm.
    """
    label = f"the robot, {drive.duration_s:.0f} s"
    trails.draw_drive(axes, factory, drive.world, drive.trail, drive.asked_at, label=label, width=width)
    # The start is hollow, for a robot that knows nothing asks there.
    axes.plot(*columns(drive.trail[:1]), "s", color=START, fillstyle="none", mew=2.0, ms=9, zorder=6, label="start")
    if drive.collided_at:
        label = f"collided ({len(drive.collided_at)})"
        axes.plot(*columns(drive.collided_at), "X", color=_COLLIDED, markersize=8, zorder=5, label=label)
