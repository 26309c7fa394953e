"""Picture of the handbook: the paper's other tasks, each driven by a robot that was taught it.

`python -m tests.experiments.tasks_picture` teaches four simulated robots, examines them, and writes `docs/tasks.png`.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import anyio

from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.core.task_settings import TaskSettings, taught_by_named
from kurt2rt.experiments.lockstep.curriculum import run_exams, run_lesson
from kurt2rt.experiments.lockstep.drawing import exams_figure
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.platform.save_figure import save_figure
from tests.experiments.helpers import ROBOT, STAGE

PICTURE = Path("docs/tasks.png")
SEEDS = {"fleeing": 1, "circle": 1, "eight": 1, "streets": 2}
"""Robot of each task; that of the streets is the one of the handbook's command."""


async def examined(task: TaskSettings, seed: int, file: Path) -> tuple[DriveRow, ...]:
    """Teach a robot a task, and return its exams."""
    _, events = await run_lesson(STAGE, ROBOT, task, file, seed=seed, report=lambda *_: None)
    return await run_exams(STAGE, ROBOT, task, events, task.exam.worlds, seed=seed, report=lambda *_: None)


def main() -> None:
    """Write the picture."""
    drives: list[DriveRow] = []
    with TemporaryDirectory() as folder:
        for name, seed in SEEDS.items():
            task = taught_by_named(load_task_and_robot(name, None)[0], "ordinary")
            drives += anyio.run(examined, task, seed, Path(folder) / name)
    save_figure(exams_figure(drives, STAGE, in_a_row=3), PICTURE)


if __name__ == "__main__":
    main()
