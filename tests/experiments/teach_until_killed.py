"""Lessons without end on one knowledge file: the child of test_kill.py, which kills it.

Prints the command id of each lesson as soon as it is acknowledged.
"""

import os
import sys
from itertools import count
from pathlib import Path

import anyio

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import run_lesson
from kurt2rt.knowledge.journal.writer import Acknowledgement
from tests.experiments.helpers import ROBOT, STAGE, short_task


def eager_task() -> TaskSettings:
    """Return a task with an erring, impatient teacher, so that lessons never run out."""
    task = short_task(3.0, 5.0)
    eager = task.teaching.teacher.model_copy(update={"reaction_s": 0.1, "patience_s": 0.05, "error_rate": 0.4})
    return task.model_copy(update={"teaching": task.teaching.model_copy(update={"teacher": eager})})


def say(saved: Acknowledgement) -> None:
    os.write(1, f"{saved.command_id}\n".encode())


async def teach_without_end(knowledge: Path, seed: int) -> None:
    task = eager_task()
    for number in count(seed):
        await run_lesson(STAGE, ROBOT, task, knowledge, seed=number, report=lambda *_: None, on_saved=say)


if __name__ == "__main__":
    anyio.run(teach_without_end, Path(sys.argv[1]), int(sys.argv[2]))
