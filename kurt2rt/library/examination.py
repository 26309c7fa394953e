"""Examination of knowledge: taught robots drive without a teacher."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from config.errors import UserError
from hal.robot_settings import load_robot
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.experiments.lockstep.curriculum import run_exams
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.library.blocking import run_blocking
from kurt2rt.library.knowledge import Knowledge
from kurt2rt.library.simulation import open_factory
from simbridge.contracts.simulation import SimulationFactory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLUMNS = ("world", "seed", "progress", "teacher's", "collisions", "verdict")


@dataclass(frozen=True, repr=False)
class Examination:
    """Drives of an examination, each with the drive of the teacher's own policy from the same start."""

    drives: tuple[DriveRow, ...]
    factory: SimulationFactory
    """Draws the worlds."""

    @property
    def passed(self) -> int:
        """Number of drives that passed."""
        return sum(drive.passed for drive in self.drives)

    @property
    def judged(self) -> int:
        """Number of drives that were judged; where the teacher's policy gets nowhere, none is."""
        return sum(drive.judged for drive in self.drives)

    def plot(self) -> "Figure":
        """Return a figure of the first drive from above, over the teacher's own, as `kurt2rt exam` draws it."""
        # Late import: matplotlib is an extra that a robot does not need.
        from kurt2rt.experiments.lockstep.drawing import exams_figure

        return exams_figure(self.drives[:1], self.factory)

    def __repr__(self) -> str:
        """Return a line for each drive, and the number that passed."""
        lines = [", ".join(f"{name} {cell}" for name, cell in zip(_COLUMNS, row, strict=True)) for row in self._rows()]
        return "\n".join([*lines, f"{self.passed} of {self.judged} judged drives passed"])

    def _repr_html_(self) -> str:
        """Return the table of the drives."""
        rows = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in self._rows())
        head = "".join(f"<th>{escape(name)}</th>" for name in _COLUMNS)
        return f"<table><tr>{head}</tr>{rows}</table><p>{self.passed} of {self.judged} judged drives passed</p>"

    def _rows(self) -> list[tuple[str, ...]]:
        return [
            (
                drive.world,
                str(drive.seed),
                f"{drive.progress:.1f} {drive.unit}",
                "" if drive.teacher is None else f"{drive.teacher.progress:.1f} {drive.teacher.unit}",
                str(drive.collisions),
                drive.verdict.text,
            )
            for drive in self.drives
        ]


def examine(
    knowledge: Knowledge,
    *,
    worlds: Sequence[str] | None = None,
    seeds: Sequence[int] = (1,),
    seconds: float | None = None,
) -> Examination:
    """Let a robot drive by its knowledge, without a teacher, in each world with each seed.

    Args:
        knowledge: that decides.
        worlds: names or paths; None: the worlds of the task.
        seeds: of the sensors, the noise and the start pose.
        seconds: duration of each drive, in s of robot time; None: as the task says.

    Raises:
        UserError: as kurt2rt.Error, there is nothing to drive, or task and worlds do not fit.
    """
    changes = None if seconds is None else {"exam.duration_s": str(seconds)}
    settings, task = load_robot(knowledge.robot), load_task(knowledge.task, changes=changes)
    if isinstance(worlds, str):
        raise UserError(f"is a text (got {worlds!r})", where="worlds", do=f"give [{worlds!r}]")
    wanted = task.exam.worlds if worlds is None else tuple(worlds)
    if not wanted or not seeds:
        raise UserError("there is no drive (got no world or no seed)", where="examine", do="give at least one of each")
    factory = open_factory(settings)
    factory.require_worlds(*wanted)
    require_metric(factory, task, wanted)

    async def drive() -> tuple[DriveRow, ...]:
        found: list[DriveRow] = []
        for seed in seeds:
            found += await run_exams(
                factory,
                settings,
                task,
                knowledge.events,
                wanted,
                seed=seed,
                report=lambda _what, _done_s, _whole_s: None,
            )
        return tuple(found)

    return Examination(run_blocking(drive), factory)
