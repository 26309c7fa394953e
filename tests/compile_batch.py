"""Compile the batch once, before several workers of pytest would each do it: `python -m tests.compile_batch`.

Numba keeps compiled code by the path of its source, so each new checkout compiles again, half a minute in each process.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import anyio

from hal.kurt2_settings import load_kurt2
from kurt2rt.core.task_settings import load_task, taught_by_named
from kurt2rt.experiments.lockstep.curriculum import run_exams, run_lesson
from kurt2rt.experiments.lockstep.engine import Engine
from simbridge.simulation import Kurt2SimulationFactory

_SHORT = {"teaching.supervised_s": "1", "teaching.corrections_s": "1", "exam.duration_s": "1"}
_TASKS = ("wall_following", "streets")
"""A task in a room and one with streets, which between them need all of the compiled functions."""


async def compile_batch() -> None:
    """Give a lesson of two seconds and examine it, in each of the tasks."""
    robot = load_kurt2()
    factory = Kurt2SimulationFactory(robot)
    for name in _TASKS:
        task = taught_by_named(load_task(name, changes=_SHORT), "ordinary")
        with TemporaryDirectory() as folder:
            _, events = await run_lesson(
                factory,
                robot,
                task,
                Path(folder) / "short.knowledge",
                seed=1,
                report=lambda *_: None,
                engine=Engine.COMPILED,
            )
        worlds = task.exam.worlds[:1]
        await run_exams(factory, robot, task, events, worlds, seed=1, report=lambda *_: None, engine=Engine.COMPILED)


if __name__ == "__main__":
    anyio.run(compile_batch)
