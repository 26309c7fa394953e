"""Pictures of a lesson and its exams: where the robot drove, where it asked, how its knowledge grew."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hal.simulation import Position, SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, WorldResult
from kurt2rt.experiments.lockstep.exam_verdict import EXAM_VERDICT_TEXTS
from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.lockstep.trails import ASKED, TRAIL, columns, draw_trail

_TEACHER = "#b0b0b0"
_CARRIED_M = 0.2
"""Greater distance of two points of a trail, 0.1 s apart: the robot was repositioned."""


def draw_curriculum(result: CurriculumResult, task: TaskSettings, factory: SimulationFactory, path: Path) -> None:
    """Write a PNG: the lesson, each exam over the teacher's own drive, and the number of RLAs against time.

    Raises OSError, and SettingsError for an unknown world.
    """
    panels = 2 + len(result.exams)
    columns = (panels + 1) // 2
    figure = Figure(figsize=(5.2 * columns, 10.0), layout="constrained")
    axes = figure.subplots(2, columns).flatten().tolist()
    lesson = result.lesson
    asks = _places("the robot asked", len(lesson.ask_positions))
    _draw_drive(axes[0], factory, lesson.world, lesson.trail, lesson.ask_positions, asks)
    axes[0].set_title(f"Lesson in world {label_of(lesson.world)}: {lesson.teaching_s:.0f} s, {len(lesson.rlas)} RLAs")
    _draw_growth(axes[1], lesson.growth, task)
    for panel, each in zip(axes[2:], result.exams, strict=False):
        _draw_exam(panel, each, factory)
    for panel in axes[panels:]:
        panel.set_axis_off()
    figure.savefig(path, dpi=110)


def draw_exams(exams: Sequence[WorldResult], factory: SimulationFactory, path: Path) -> None:
    """Write a PNG: each exam over the teacher's own drive, one below the other as a phone shows them.

    Raises OSError, and SettingsError for an unknown world.
    """
    figure = Figure(figsize=(5.2, 5.2 * len(exams)), layout="constrained")
    for panel, each in zip(figure.subplots(len(exams), 1, squeeze=False).flatten(), exams, strict=True):
        _draw_exam(panel, each, factory)
    figure.savefig(path, dpi=110, format="png")


def _draw_exam(panel: Axes, result: WorldResult, factory: SimulationFactory) -> None:
    exam, teachers = result.learned, result.teacher.trail
    draw_trail(panel, teachers, "teacher's own drive", carried_m=_CARRIED_M, colour=_TEACHER, width=3.0, zorder=2)
    unknown = _places("situation unknown", len(exam.unknown_positions))
    _draw_drive(panel, factory, exam.world, exam.trail, exam.unknown_positions, unknown)
    verdict = "success" if result.succeeded else EXAM_VERDICT_TEXTS[result.verdict]
    panel.set_title(
        f"Exam in world {label_of(exam.world)}: {exam.progress:.1f} {exam.unit}, {exam.collisions} collisions, "
        f"{verdict}"
    )


def _draw_drive(
    axes: Axes, factory: SimulationFactory, world: str, trail: Sequence[Position], marks: Sequence[Position], label: str
) -> None:
    factory.draw(axes, world)
    draw_trail(axes, trail, "the robot", carried_m=_CARRIED_M)
    if marks:
        axes.plot(*columns(marks), "o", color=ASKED, markersize=5, zorder=4, label=label)
    # Below the floor plan, where no wall is hidden by it.
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=3, fontsize="small", frameon=False)


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


def _places(what: str, count: int) -> str:
    return f"{what} ({count} times)"
