"""Study of one task: the same curriculum for many seeds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, Report, run_exams, run_lesson
from kurt2rt.experiments.lockstep.seed_result import SeedResult, seed_result
from kurt2rt.experiments.study.jobs import JobParts, StudyJob
from kurt2rt.experiments.study.loop_choice import ALL_ON_BUS, LoopChoice, RequestedLoops, choose_loops
from kurt2rt.experiments.study.pool import Progress
from kurt2rt.experiments.study.provenance import Fingerprints, Provenance
from kurt2rt.experiments.study.results import Results
from kurt2rt.knowledge.files.archive_existing import archive_existing


class SeedOutcome(SeedResult):
    """Numbers of one robot, with their provenance."""

    made_of: Provenance


@dataclass(frozen=True, slots=True, kw_only=True)
class CurriculumJob(StudyJob):
    """Training run and exams of one robot."""

    outcome = SeedOutcome
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True

    @property
    def robot_time_s(self) -> float:
        """Time of the lesson, and in each world of the exam and of the teacher's own drive, in s."""
        return self.task.teaching.duration_s + 2 * len(self.task.exam.worlds) * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> SeedOutcome:
        """Teach the robot into the file `knowledge`, examine it and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError, BatchRefusedError.
        """
        factory, robot, task, seed, loops = self.factory, self.robot, self.task, self.seed, self.loops
        lesson, events = await run_lesson(factory, robot, task, knowledge, seed=seed, report=report, loop=loops.lesson)
        exams = await run_exams(
            factory, robot, task, events, task.exam.worlds, seed=seed, report=report, loop=loops.exams
        )
        result = seed_result(CurriculumResult(lesson, exams))
        return SeedOutcome(made_of=self.made_of, lesson=result.lesson, exams=result.exams)


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedJob(CurriculumJob):
    """Training run and exams of one seed."""

    replaces_others: ClassVar[bool] = True
    label: str = ""
    """End of the names of result and knowledge, for a robot of a control; empty otherwise."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of the result, without the top folder and the ending."""
        return f"{self.task.name}-{self.seed}{self.label}"

    @property
    def knowledge_name(self) -> str:
        """Path of the stored knowledge within the folder of results."""
        return f"{self.stem}.knowledge"

    def run(self, on_progress: Progress) -> None:
        """Run the job, and store result and knowledge; an earlier knowledge file of the robot gets a new name.

        `on_progress` gets robot time in s. Raises the errors of `measure`, and OSError if results cannot be stored.
        """
        archive_existing(self.knowledge)
        super(SeedJob, self).run(on_progress)


@dataclass(frozen=True, slots=True)
class SeedPlan:
    """Jobs of the study."""

    jobs: Mapping[str, tuple[SeedJob, ...]]
    """Jobs of each way of teaching, by its label, in the order of the seeds."""

    choice: LoopChoice
    """Loops of the jobs."""

    @property
    def every_job(self) -> tuple[SeedJob, ...]:
        """Jobs of all ways of teaching, without witnesses."""
        return tuple(job for jobs in self.jobs.values() for job in jobs)

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """All jobs and witnesses in one wave: no job needs another."""
        return ((*self.every_job, *self.choice.witnesses(self.every_job)),)


def make_plan(
    tasks: Mapping[str, TaskSettings],
    seeds: Sequence[int],
    parts: JobParts,
    *,
    loops: RequestedLoops = ALL_ON_BUS,
) -> SeedPlan:
    """Return the jobs.

    Args:
        tasks: the task by the label of each way of teaching, its own first.
        seeds: one robot each.
        parts: factory, robot and results of the jobs.
        loops: requested for lessons and exams.

    Raises:
        hal.settings.SettingsError: settings of a task or a world cannot be loaded.
    """
    factory = parts["factory"]
    fingerprints = Fingerprints(factory, parts["robot"], ("paper", "plain", "phases"))
    jobs = {}
    for place, (label, task) in enumerate(tasks.items()):
        made = fingerprints.of(task, (task.teaching.world, *task.exam.worlds))
        end = f"-control-{place}" if place else ""
        jobs[label] = tuple(SeedJob(task=task, seed=seed, label=end, made_of=made, **parts) for seed in seeds)
    choice = choose_loops([job for each in jobs.values() for job in each], loops, parts["robot"])
    return SeedPlan({label: choice.apply(each) for label, each in jobs.items()}, choice)


def forget_lost_robots(plan: SeedPlan, results: Results) -> None:
    """Delete each result whose robot has no knowledge file, because its robot is taught again. Raises OSError."""
    for job in plan.every_job:
        if not job.knowledge.exists():
            (results.folder / job.file).unlink(missing_ok=True)


def forget_result(folder: Path, task: str, seed: int) -> None:
    """Delete the result of the robot whose knowledge file gets another content. Raises OSError."""
    (folder / f"results/{task}-{seed}.json").unlink(missing_ok=True)


def read_results(plan: SeedPlan, results: Results) -> dict[str, list[SeedOutcome]]:
    """Return the outcomes by the label of the way of teaching. Raises StudyError if one is missing or damaged."""
    return {label: [results.read(job, SeedOutcome) for job in jobs] for label, jobs in plan.jobs.items()}
