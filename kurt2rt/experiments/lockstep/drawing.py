"""Pictures of a lesson and its exams: where the robot drove, where it asked, how its knowledge grew."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.drive_row import DriveRow, label_of
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.trails import draw_drive, draw_way, legend_below, panels_of
from kurt2rt.platform.drive_picture import TRAIL, draw_trail
from kurt2rt.platform.save_figure import save_figure
from simbridge.contracts.simulation import SimulationFactory

_TEACHER = "#b0b0b0"
_SIDE = 5.2
"""Side of a drive's panel, in inches."""


def draw_curriculum(
    lesson: TrainingResult, exams: Sequence[DriveRow], task: TaskSettings, factory: SimulationFactory, path: Path
) -> None:
    """Write a PNG: the lesson, each exam over the teacher's own drive, and the number of RLAs against time.

    Raises OSError, and SettingsError for an unknown world.
    """
    figure, axes = panels_of(2 + len(exams), (3 + len(exams)) // 2, (_SIDE, _SIDE))
    draw_way(axes[0], factory, lesson.counts.world, lesson.trail, lesson.ask_positions, lesson.collided_at)
    legend_below(axes[0])
    axes[0].set_title(
        f"Lesson in world {label_of(lesson.counts.world)}: {lesson.counts.teaching_s:.0f} s, {len(lesson.rlas)} RLAs"
    )
    _draw_growth(axes[1], lesson.growth, task)
    for panel, each in zip(axes[2:], exams, strict=True):
        _draw_exam(panel, each, factory)
    save_figure(figure, path)


def exams_figure(exams: Sequence[DriveRow], factory: SimulationFactory, in_a_row: int = 1) -> Figure:
    """Return each exam over the teacher's own drive; one in a row is what a phone shows.

    Raises SettingsError for an unknown world.
    """
    figure, panels = panels_of(len(exams), in_a_row, (_SIDE, _SIDE))
    for panel, each in zip(panels, exams, strict=True):
        _draw_exam(panel, each, factory)
    return figure


def drive_figure(factory: SimulationFactory, world: str, drive: Episode) -> Figure:
    """Return a drive so far, in its world from above. Raises SettingsError for an unknown world."""
    figure, (axes,) = panels_of(1, 1, (_SIDE, _SIDE))
    draw_way(axes, factory, world, drive.trail, drive.ask_positions, drive.collided_at)
    if drive.trail or drive.ask_positions:
        legend_below(axes)
    return figure


def _draw_exam(panel: Axes, exam: DriveRow, factory: SimulationFactory) -> None:
    assert exam.teacher is not None
    draw_trail(panel, exam.teacher.trail, "teacher's own drive", colour=_TEACHER, width=3.0, zorder=2)
    draw_drive(panel, factory, exam)
    legend_below(panel)
    verdict = "success" if exam.passed else exam.verdict.text
    panel.set_title(
        f"Exam in world {label_of(exam.world)}:\n{exam.progress:.1f} {exam.unit}, {exam.collisions} collisions, "
        f"{verdict}"
    )


def _draw_growth(axes: Axes, growth: Sequence[int], task: TaskSettings) -> None:
    axes.plot(range(1, len(growth) + 1), growth, color=TRAIL, linewidth=2.0)
    if task.paper.teaching_s:
        axes.plot([task.paper.teaching_s], [task.paper.rlas], "k*", markersize=12, linestyle="none", label="paper")
    axes.axvline(task.teaching.supervised_s, color=_TEACHER, linestyle="--", label="corrections begin (phase 2)")
    axes.set_xlabel("teaching, s of robot time")
    axes.set_ylabel("RLAs")
    axes.set_ylim(bottom=0)
    axes.set_title("Growth of the RLA system")
    axes.legend(frameon=False)
