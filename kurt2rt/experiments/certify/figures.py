"""Pictures of the worst runs of a certificate."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from hal.simulation import SimulationFactory
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.lockstep.trails import ASKED, columns, draw_trail
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.figure_style import COLLIDED, START, legend_below, save

_CARRIED_M = 0.2
"""Greater distance of two points of a trail, 0.1 s apart: the robot was repositioned."""


def draw_worst(
    exams: Sequence[ExamResult], commands: Sequence[str], factory: SimulationFactory, folder: Path
) -> Iterator[SavedFigure]:
    """Draw each run into the folder and yield it: run-NUMBER.png.

    `commands`: by which a user drives each run again. Raises OSError.
    """
    for exam, command in zip(exams, commands, strict=True):
        path = folder / f"run-{exam.seed}.png"
        draw_run(exam, factory, path)
        yield SavedFigure(path, f"Run {exam.seed}: {_format_run(exam)}", command)


def draw_run(exam: ExamResult, factory: SimulationFactory, path: Path) -> None:
    """Draw the drive of one run, its questions and its collisions, as a PNG to `path`. Raises OSError."""
    figure = Figure(figsize=(5.6, 6.0), layout="constrained")
    axes = figure.subplots()
    factory.draw(axes, exam.world)
    draw_trail(axes, exam.trail, "the robot", carried_m=_CARRIED_M)
    marks = (
        (exam.trail[:1], "o", START, "start"),
        (exam.unknown_positions, "o", ASKED, "situation unknown"),
        (exam.collision_positions, "x", COLLIDED, "collision"),
    )
    for places, marker, colour, label in marks:
        if places:
            axes.plot(*columns(places), marker, color=colour, markersize=6, zorder=5, label=label)
    axes.set_title(f"Run {exam.seed} in world {label_of(exam.world)}")
    legend_below(axes, columns=4)
    save(figure, path)


def _format_run(exam: ExamResult) -> str:
    """Return a run in a line, such as `world A, 2 collisions, stuck after 81 s`."""
    collisions = f"{exam.collisions} collision{'' if exam.collisions == 1 else 's'}"
    end = exam.alarm or ("stuck" if exam.stuck else "")
    asked = f"{len(exam.unknown_positions)} times in the unknown" if exam.unknown_positions else ""
    parts = (f"world {label_of(exam.world)}", collisions, asked, f"{end} after {exam.duration_s:.0f} s" if end else "")
    return ", ".join(part for part in parts if part)
