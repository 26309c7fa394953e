"""Figures of the paper, drawn from our results, and one figure of drives for each task."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from kurt2rt.core.task_settings import PaperResult
from kurt2rt.experiments.lockstep.drive_row import DriveRow, ExamVerdict, label_of
from kurt2rt.experiments.lockstep.trails import draw_drive, legend_below, panels_of
from kurt2rt.experiments.paper.study import GrowthStudy, PaperStudy
from kurt2rt.experiments.study.figures import SavedFigure, draw_passed, saved
from kurt2rt.experiments.study.table import collisions_text
from kurt2rt.platform.drive_picture import START, draw_robot
from simbridge.contracts.simulation import SimulationFactory

_COLUMNS = 3
_MOST_UNSEEN = 1
"""Generated worlds in the picture of a task."""
_SUCCESS_WORDS = {ExamVerdict.PASSED: "success", ExamVerdict.FAILED: "no success"}


def _drives(factory: SimulationFactory, drives: Sequence[DriveRow]) -> Figure:
    """Return a panel for each drive: trail, start, unknown situations and collisions."""
    figure, panels = panels_of(len(drives), 2 if len(drives) == 4 else _COLUMNS, (5.0, 5.4))
    for axes, drive in zip(panels, drives, strict=True):
        draw_drive(axes, factory, drive)
        axes.set_title(_format_drive(drive), fontsize="medium")
        legend_below(axes)
    return figure


def _format_drive(drive: DriveRow) -> str:
    end = f", {drive.early_end}" if drive.early_end else ""
    progress = f"{label_of(drive.world)}: {drive.progress:.1f} {drive.unit}, {collisions_text(drive.collisions)}"
    return f"{progress}\n{_SUCCESS_WORDS.get(drive.verdict, drive.verdict.text)}{end}"


_TITLES = {"shipped": "With the shipped settings", "plain": "Plain reading of the paper"}


def _growth(studies: Sequence[GrowthStudy], paper: PaperResult) -> Figure:
    """Return the number of RLAs against time for each R, a panel for each reading; a star is the paper's text."""
    figure = Figure(figsize=(5.6 * len(studies), 4.8), layout="constrained")
    panels = figure.subplots(1, len(studies), squeeze=False, sharey=True)[0]
    for axes, study in zip(panels, studies, strict=True):
        colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(study.curves)))
        for (radius, curves), colour in zip(study.curves.items(), colours, strict=True):
            last_s = min(map(len, curves))
            low, median, high = np.percentile([curve[:last_s] for curve in curves], (25, 50, 75), axis=0)
            time_s = np.arange(1, last_s + 1)
            axes.fill_between(time_s, low, high, color=colour, alpha=0.2, linewidth=0)
            axes.plot(time_s, median, color=colour, linewidth=1.8, label=f"R = {radius:g}")
        if paper.teaching_s:
            label = f"the paper's text: {paper.rlas} RLAs, {paper.teaching_s:g} s"
            axes.plot([paper.teaching_s], [paper.rlas], "k*", markersize=12, linestyle="none", label=label)
        axes.set_title(_TITLES[study.reading])
        axes.set_xlabel("teaching in phase 1, s of robot time")
        axes.set_xlim(left=0)
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("RLAs")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    return figure


def _testing_ground(factory: SimulationFactory, world: str) -> Figure:
    figure = Figure(figsize=(5.6, 6.0), layout="constrained")
    axes = figure.subplots()
    factory.draw(axes, world)
    with closing(factory.open(world, 1, "exam")) as simulation:
        draw_robot(axes, simulation.pose, factory.settings.geometry.outline_m, START, "start")
    return figure


def _worlds(factory: SimulationFactory, worlds: Sequence[str]) -> Figure:
    figure, panels = panels_of(len(worlds), 2, (5.0, 5.0))
    for axes, world in zip(panels, worlds, strict=True):
        factory.draw(axes, world)
        axes.set_title(f"World {label_of(world)}" if len(world) == 1 else f"{world.capitalize()} world")
    return figure


def draw_figures(study: PaperStudy, factory: SimulationFactory, folder: Path) -> Iterator[SavedFigure]:
    """Draw each figure into the folder and yield it: passed.png, drive-<task>.png, fig2.png, fig4.png and so on.

    Figures of tasks that are not in the study are left out. Raises OSError.
    """
    paper = study.plan.about.paper
    shipped = study.of("shipped")
    drives = {
        f"{each.of.label}, {each.of.reading}": [drive for robot in each.rows for drive in robot.drives]
        for each in study.experiments
    }
    yield draw_passed(drives, "By task and settings, all robots in all worlds of the task.", folder / "passed.png")
    for each in shipped:
        robot = each.rows[0]
        own = [drive for drive in robot.drives if drive.world in each.of.task.exam.worlds]
        others = [drive for drive in robot.drives if drive not in own]
        yield saved(
            _drives(factory, [*own, *others[:_MOST_UNSEEN]]),
            folder / f"drive-{each.of.task.name}.png",
            each.of.settings.title,
            f"Exams of the robot of seed {robot.seed}, the first one, after {robot.lesson.teaching_s:g} s of teaching, "
            f"with {robot.lesson.rlas} RLAs.",
        )
    if study.growth:
        task = next(each.of.task for each in study.experiments if each.of.task.name == study.growth[0].task)
        robots = max(map(len, study.growth[0].curves.values()))
        yield saved(
            _growth(study.growth, task.paper),
            folder / "fig2.png",
            "Fig. 2: RLAs against teaching time for several R",
            f"{task.name}, phase 1 only. Median (line) and quartiles (band) of {robots} robots for each R. The "
            "star is the only number in the paper's text, for both phases; the paper does not tell its R.",
        )
    ground = _testing_ground(factory, paper.testing_ground)
    told = f"World {label_of(paper.testing_ground)}, the testing ground, with the robot at a start pose, to scale."
    yield saved(ground, folder / "fig4.png", "Fig. 4: the testing environment", told)
    told = "World A is the one that is taught in."
    yield saved(_worlds(factory, paper.worlds), folder / "fig6.png", "Fig. 6: the test worlds", told)
    for each in shipped:
        robot = each.rows[0]
        drive = robot.drives[0]
        if each.of.settings.task == paper.eight:
            yield saved(
                _drives(factory, [drive]),
                folder / "fig7.png",
                "Fig. 7: the eight round two columns",
                f"The exam of the robot of seed {robot.seed} without its teacher: {drive.progress:.1f} {drive.unit} in "
                f"{drive.duration_s:.0f} s, {drive.collisions} collisions. It is the first of the seeds, and was not "
                "chosen.",
            )
