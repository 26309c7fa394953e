"""Figures in files, in the style that all of them share."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.study.intervals import wilson_interval
from kurt2rt.experiments.study.table import of_text
from kurt2rt.platform.drive_picture import TRAIL
from kurt2rt.platform.save_figure import save_figure


class SavedFigure(NamedTuple):
    """Figure of a report: its PNG file, and the title and caption printed with it."""

    path: Path
    title: str
    caption: str


def saved(figure: Figure, path: Path, title: str, caption: str) -> SavedFigure:
    """Write a figure of a report to a PNG file and return it with its texts. Raises OSError."""
    save_figure(figure, path)
    return SavedFigure(path, title, caption)


class Estimate(NamedTuple):
    """Line of a picture: a name, a value with its 95 % interval, and the text that stands there."""

    name: str
    value: float
    low: float
    high: float
    text: str


def draw_passed(groups: Mapping[str, Sequence[DriveRow]], caption: str, path: Path) -> SavedFigure:
    """Draw the share of the judged drives that passed, of each group by its name; return the figure. Raises OSError."""
    estimates = []
    for name, drives in groups.items():
        passed, judged = sum(each.passed for each in drives), sum(each.judged for each in drives)
        low, high = wilson_interval(passed, judged) if judged else (0.0, 1.0)
        estimates.append(Estimate(name, passed / max(judged, 1), low, high, of_text(passed, judged)))
    return saved(draw_estimates(estimates, "share of the exams that passed"), path, "Exams without a teacher", caption)


def draw_estimates(estimates: Sequence[Estimate], unit: str) -> Figure:
    """Return a figure with a line for each estimate, the first on top: a dot, its interval and its text."""
    figure = Figure(figsize=(8.0, 1.0 + 0.42 * len(estimates)), layout="constrained")
    axes = figure.subplots()
    for at, each in enumerate(estimates):
        axes.plot([each.low, each.high], [at, at], color=TRAIL, linewidth=6.0, alpha=0.3, solid_capstyle="butt")
        axes.plot([each.value], [at], "o", color=TRAIL, markersize=8)
        axes.annotate(each.text, (1.02, at), xycoords=("axes fraction", "data"), va="center")
    axes.set_yticks(range(len(estimates)), [each.name for each in estimates])
    axes.set_ylim(len(estimates) - 0.5, -0.5)
    axes.set_xlim(left=0.0)
    axes.set_xlabel(f"{unit}; bars: 95 % interval")
    axes.grid(axis="x", alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    return figure
