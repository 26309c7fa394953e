"""Fig. 7, and beyond the paper a picture of a taught robot's drives in each task."""

import math
from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from hal.simulation import SimulationFactory
from kurt2rt.experiments.lockstep.exam_verdict import EXAM_VERDICT_TEXTS, ExamVerdict
from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.lockstep.trails import ASKED, columns, draw_trail
from kurt2rt.experiments.paper.outcome import DriveOutcome
from kurt2rt.experiments.study.figure_style import COLLIDED, START, legend_below, save

_LIFTED_M = 0.5
"""A robot that is so far from where it was a moment ago was set down elsewhere."""
_COLUMNS = 3
_VERDICT_TEXTS = {**EXAM_VERDICT_TEXTS, ExamVerdict.PASSED: "success", ExamVerdict.FAILED: "no success"}


def draw_eight(stage: SimulationFactory, drive: DriveOutcome, path: Path) -> None:
    """Fig. 7: the way round the two columns, with its start."""
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    axes = figure.subplots()
    _draw_drive(axes, stage, drive)
    legend_below(axes, columns=4)
    save(figure, path)


def draw_drives(stage: SimulationFactory, drives: Sequence[DriveOutcome], path: Path) -> None:
    """A panel per drive: the way, its start, where the robot did not know the situation and where it collided."""
    columns = 2 if len(drives) == 4 else min(_COLUMNS, len(drives))
    rows = math.ceil(len(drives) / columns)
    figure = Figure(
        figsize=(max(5.4, 4.6 * columns), 5.4 * rows), layout=ConstrainedLayoutEngine(h_pad=0.15, w_pad=0.1)
    )
    panels = figure.subplots(rows, columns, squeeze=False).flatten().tolist()
    for axes, drive in zip(panels, drives, strict=False):
        _draw_drive(axes, stage, drive)
        axes.set_title(_told(drive), fontsize="medium")
        legend_below(axes, columns=2)
    for axes in panels[len(drives) :]:
        axes.set_axis_off()
    save(figure, path)


def _told(drive: DriveOutcome) -> str:
    collisions = f"{drive.collisions} collision{'' if drive.collisions == 1 else 's'}"
    verdict = _VERDICT_TEXTS[drive.verdict]
    early = drive.alarm or ("stuck" if drive.stuck else "")
    end = f", {early} after {drive.duration_s:.0f} s" if early else ""
    return f"{label_of(drive.world)}: {drive.progress:.1f} {drive.unit}, {collisions}\n{verdict}{end}"


def _draw_drive(axes: Axes, stage: SimulationFactory, drive: DriveOutcome) -> None:
    stage.draw(axes, drive.world)
    draw_trail(axes, drive.trail, f"the robot, {drive.duration_s:.0f} s", carried_m=_LIFTED_M, width=0.9)
    if drive.trail:
        # Hollow, for a robot that knows nothing asks where it starts.
        axes.plot(*columns(drive.trail[:1]), "s", color=START, fillstyle="none", mew=2.0, ms=9, zorder=6, label="start")
    if drive.asked_at:
        label = f"situation unknown ({len(drive.asked_at)})"
        axes.plot(*columns(drive.asked_at), "o", color=ASKED, markersize=4, zorder=4, label=label)
    if drive.collided_at:
        label = f"collided ({len(drive.collided_at)})"
        axes.plot(*columns(drive.collided_at), "X", color=COLLIDED, markersize=8, zorder=5, label=label)
