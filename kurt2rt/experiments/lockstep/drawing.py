"""Pictures of a lesson and its exams: where the robot drove, where it asked, how its knowledge grew."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.drive_row import DriveRow, label_of
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.trails import TRAIL, draw_drive, draw_trail, legend_below
from simbridge.contracts.simulation import SimulationFactory

_TEACHER = "#b0b0b0"


def draw_curriculum(
    lesson: TrainingResult, exams: Sequence[DriveRow], task: TaskSettings, factory: SimulationFactory, path: Path
) -> None:
    """Write a PNG: the lesson, each exam over the teacher's own drive, and the number of RLAs against time.

    Raises OSError, and SettingsError for an unknown world.
    """
    panels = 2 + len(exams)
    columns = (panels + 1) // 2
    figure = Figure(figsize=(5.2 * columns, 10.0), layout="constrained")
    axes = figure.subplots(2, columns).flatten().tolist()
    draw_drive(axes[0], factory, lesson.counts.world, lesson.trail, lesson.ask_positions)
    legend_below(axes[0])
    axes[0].set_title(
        f"Lesson in world {label_of(lesson.counts.world)}: {lesson.counts.teaching_s:.0f} s, {len(lesson.rlas)} RLAs"
    )
    _draw_growth(axes[1], lesson.growth, task)
    for panel, each in zip(axes[2:], exams, strict=False):
        _draw_exam(panel, each, factory)
    for panel in axes[panels:]:
        panel.set_axis_off()
    figure.savefig(path, dpi=110)


def draw_exams(exams: Sequence[DriveRow], factory: SimulationFactory, path: Path) -> None:
    """Write a PNG: each exam over the teacher's own drive, one below the other as a phone shows them.

    Raises OSError, and SettingsError for an unknown world.
    """
    figure = Figure(figsize=(5.2, 5.2 * len(exams)), layout="constrained")
    for panel, each in zip(figure.subplots(len(exams), 1, squeeze=False).flatten(), exams, strict=True):
        _draw_exam(panel, each, factory)
    figure.savefig(path, dpi=110, format="png")


def _draw_exam(panel: Axes, exam: DriveRow, factory: SimulationFactory) -> None:
    assert exam.teacher is not None
    draw_trail(panel, exam.teacher.trail, "teacher's own drive", colour=_TEACHER, width=3.0, zorder=2)
    draw_drive(panel, factory, exam.world, exam.trail, exam.asked_at)
    legend_below(panel)
    verdict = "success" if exam.passed else exam.verdict.text
    panel.set_title(
        f"Exam in world {label_of(exam.world)}: {exam.progress:.1f} {exam.unit}, {exam.collisions} collisions, "
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
