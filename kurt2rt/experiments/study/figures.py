"""Figures in files, in the style that all of them share."""

import math
from pathlib import Path
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine


class SavedFigure(NamedTuple):
    """Figure of a report: its PNG file, and the title and caption printed with it."""

    path: Path
    title: str
    caption: str


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
