"""Figures in files, in the style that all of them share."""

from pathlib import Path
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLLIDED = "#111111"
START = "#2e8540"
_DPI = 130


class SavedFigure(NamedTuple):
    """A PNG, and what it shows."""

    path: Path
    title: str
    caption: str


def save(figure: Figure, path: Path) -> None:
    """Save a figure as a PNG whose bytes depend on its content only. Raises OSError."""
    figure.savefig(path, dpi=_DPI, metadata={"Software": None})


def legend_below(axes: Axes, columns: int = 3) -> None:
    """Draw the legend below the floor plan, in so many columns, where it hides no wall."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=columns, fontsize="small", frameon=False)
