"""Knowledge of a robot in a file, and its making by a scripted teacher."""

import math
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Self

from config.errors import UserError
from hal.robot_settings import load_robot, load_robot_of, robot_named
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_robot import require_robot_of
from kurt2rt.core.task_settings import load_task, taught_by_named
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.experiments.lockstep.curriculum import run_lesson
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import read_knowledge
from kurt2rt.library.blocking import run_blocking
from kurt2rt.library.simulation import open_factory


@dataclass(frozen=True, repr=False, kw_only=True)
class Knowledge:
    """All that a robot was taught: the RLAs of one task, read from a file."""

    path: Path
    task: str
    """Name or path of the task."""
    robot: str
    """Name of the robot's settings."""
    rlas: tuple[Rla, ...]
    """Active RLAs of the basic level."""
    events: tuple[TeachingEvent, ...]
    """Lessons, undos and beginnings of sessions, in the order of teaching."""
    lessons: int
    """Number of lessons that stand, as `kurt2rt knowledge show` counts them."""
    statistics: Statistics
    """Uses and values of the RLAs."""

    @classmethod
    def load(cls, path: str | PathLike[str], *, task: str | None = None, robot: str | None = None) -> Self:
        """Read a knowledge file, which stays as it is.

        Args:
            path: of the file.
            task: name or path; None: the task that the file names.
            robot: name or path of the robot's settings; None: the robot of the task.

        Raises:
            UserError: as kurt2rt.Error, the file cannot be read, or belongs to another task or robot.
        """
        file = Path(path)
        name = task_of_file(file, task)
        robot = robot_named(robot, name)
        settings = load_robot(robot)
        events, statistics = read_knowledge(file, settings, load_task(name))
        with Journal.read_only(file) as journal:
            system = fold_journal(journal, radius=math.inf)
        return cls(
            path=file,
            task=name,
            robot=robot,
            rlas=system.rlas,
            events=tuple(events),
            lessons=system.history.standing,
            statistics=statistics,
        )

    def __repr__(self) -> str:
        """Return task, number of RLAs, number of lessons, and file."""
        return f"Knowledge of {self.task}: {len(self.rlas)} RLAs from {self.lessons} lessons ({self.path})"


def teach(
    path: str | PathLike[str],
    *,
    task: str = "wall_following",
    seed: int = 1,
    seconds: float | None = None,
    robot: str | None = None,
    teacher: str = "ordinary",
) -> Knowledge:
    """Let a scripted teacher teach a simulated robot; return the knowledge, kept in a new file.

    Args:
        path: of the new file.
        task: name or path of the task.
        seed: of the robot and the teacher.
        seconds: robot time in which the teacher answers; corrections last as long. None: as the task says.
        robot: name or path of the robot's settings; None: the robot of the task.
        teacher: name or path of the scripted teacher; `superhuman` has none of a person's delays and slips.

    Raises:
        UserError: as kurt2rt.Error, there is a file already, or settings do not fit.
    """
    file, settings = Path(path), load_robot_of(robot, task)
    if file.exists():
        raise UserError("there is a file already", where=file, do="give the path of a new file")
    loaded = taught_by_named(load_task(task, changes=_duration(seconds)), teacher)
    require_robot_of(loaded, task, settings)
    factory = open_factory(settings)
    require_metric(factory, loaded, [loaded.teaching.world])

    async def lesson() -> None:
        await run_lesson(factory, settings, loaded, file, seed=seed, report=lambda _what, _done_s, _whole_s: None)

    run_blocking(lesson)
    return Knowledge.load(file, task=task, robot=robot)


def _duration(seconds: float | None) -> dict[str, str] | None:
    if seconds is None:
        return None
    return {"teaching.supervised_s": str(seconds), "teaching.corrections_s": str(seconds)}
