"""The same curriculum for many seeds, in parallel processes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, run_exams, run_lesson
from kurt2rt.experiments.lockstep.exam_driver import ON_BUS, ExamDriver
from kurt2rt.experiments.lockstep.lesson_driver import LESSON_ON_BUS, LessonDriver
from kurt2rt.experiments.study.pool import JobKilledError, Progress, run_jobs
from kurt2rt.experiments.study.progress_sum import ProgressSum


@dataclass(frozen=True, slots=True)
class SeedJob:
    """Job of one seed: training run into a knowledge file, then exams."""

    factory: SimulationFactory
    settings: RobotSettings
    task: TaskSettings
    worlds: tuple[str, ...]
    seed: int
    knowledge: Path
    driver: ExamDriver = ON_BUS
    """Loop of the exams."""
    lesson_driver: LessonDriver = LESSON_ON_BUS
    """Loop of the lesson."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the lesson, and in each world of the exam and of the teacher's own drive, in s."""
        return self.task.teaching.duration_s + 2 * len(self.worlds) * self.task.exam.duration_s

    def run(self, tell: Progress) -> CurriculumResult:
        """Teach and examine the robot of one seed and return the result; `tell` gets the simulated seconds.

        Raises KnowledgeError, SettingsError, LessonLostError, BatchRefusedError, BatchDiffersError.
        """
        report = ProgressSum(tell).report

        async def run() -> CurriculumResult:
            lesson, events = await run_lesson(
                self.factory,
                self.settings,
                self.task,
                self.knowledge,
                seed=self.seed,
                report=report,
                driver=self.lesson_driver,
            )
            exams = await run_exams(
                self.factory,
                self.settings,
                self.task,
                events,
                self.worlds,
                seed=self.seed,
                report=report,
                driver=self.driver,
            )
            return CurriculumResult(lesson, exams)

        return anyio.run(run)


def run_seeds(jobs: Sequence[SeedJob], processes: int, on_done: Callable[[int], None]) -> list[CurriculumResult]:
    """Run all jobs; return their results in the order of the jobs.

    `on_done` gets the index of each job that is through. Raises JobKilledError and the errors of a job.
    """
    try:
        return run_jobs(jobs, processes, on_done=lambda place: on_done(jobs[place].seed))
    except JobKilledError as error:
        raise JobKilledError(str(error), do="run again, with fewer --jobs it needs less") from error
