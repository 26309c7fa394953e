"""The same curriculum for many seeds, in parallel processes."""

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import anyio
from threadpoolctl import threadpool_limits

from hal.robot_settings import RobotSettings
from kurt2rt.experiments.arena import Stage
from kurt2rt.experiments.curriculum import CurriculumResult, run_exams, run_lesson
from kurt2rt.tasks.settings import TaskSettings


@dataclass(frozen=True, slots=True)
class SeedJob:
    """What one process does: teach with one seed into a knowledge file, then examine."""

    stage: Stage
    settings: RobotSettings
    task: TaskSettings
    worlds: tuple[str, ...]
    seed: int
    knowledge: Path


def run_seed(job: SeedJob) -> CurriculumResult:
    """Teach and examine one seed."""

    async def run() -> CurriculumResult:
        lesson, events = await run_lesson(
            job.stage, job.settings, job.task, job.knowledge, seed=job.seed, report=_say_nothing
        )
        exams = await run_exams(
            job.stage, job.settings, job.task, events, job.worlds, seed=job.seed, report=_say_nothing
        )
        return CurriculumResult(lesson, exams)

    # As on the command line: this process shares the machine with its siblings.
    with threadpool_limits(limits=1):
        return anyio.run(run)


def run_seeds(jobs: Sequence[SeedJob], processes: int, on_done: Callable[[int], None]) -> list[CurriculumResult]:
    """Run all jobs; results in the order of the jobs. `on_done` hears each seed that is through."""
    # Fresh interpreters: a fork would share the parent's threads and buses half-way.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        running = {pool.submit(run_seed, job): job.seed for job in jobs}
        try:
            for future in as_completed(running):
                future.result()
                on_done(running[future])
        except BaseException:
            # Else what failed would be said when all the others are through, minutes later.
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [future.result() for future in running]


def _say_nothing(_what: str, _done_s: float, _whole_s: float) -> None:
    """Progress of one seed is not shown: bars of parallel processes would write over each other."""
