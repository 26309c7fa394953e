"""Picture of the handbook: the paper's other tasks, each driven by a robot that was taught it.

`python -m tests.experiments.tasks_picture` teaches four simulated robots, examines them, and writes `docs/tasks.png`.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.core.task_settings import taught_by_named
from kurt2rt.experiments.lockstep.drawing import exams_figure
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.platform.save_figure import save_figure
from tests.experiments.helpers import STAGE, examined, teach

PICTURE = Path("docs/tasks.png")
SEEDS = {"fleeing": 1, "circle": 1, "eight": 1, "streets": 2}
"""Robot of each task; that of the streets is the one of the handbook's command."""


def main() -> None:
    """Write the picture."""
    drives: list[DriveRow] = []
    with TemporaryDirectory() as folder:
        for name, seed in SEEDS.items():
            task = taught_by_named(load_task_and_robot(name, None)[0], "ordinary")
            drives += examined(task, teach(Path(folder) / name, task, seed).events, task.exam.worlds, seed)
    save_figure(exams_figure(drives, STAGE, in_a_row=3), PICTURE)


if __name__ == "__main__":
    main()
