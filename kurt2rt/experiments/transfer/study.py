"""Transfer study: each robot is taught at home, and then on in new worlds, and examined there and at home."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import ClassVar, NamedTuple

from config.settings import SettingsError
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.study.checkpoints import Checkpoint, run_checkpoints
from kurt2rt.experiments.study.examiner import Examiner
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places, world_of
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import ALL_ON_BUS, RequestedEngine, StudyPlan
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons

AFTER = (0, 2, 5, 10, 15, 20)
"""Numbers of presses after which a robot is examined."""
PURPOSE = "new-world"
"""Purpose of the simulation in which a robot is taught on: another start and other noise than at home."""


def task_in(world: str, task: TaskSettings, teacher: str | None = None) -> TaskSettings:
    """Return the task to teach and examine in a new world, by its name; `teacher`: None: the teacher of home.

    Raises config.settings.SettingsError if the teacher cannot be loaded.
    """
    if teacher is not None:
        task = taught_by(task, load_teacher(teacher))
    teaching = task.teaching.model_copy(update={"world": world})
    exam = task.exam.model_copy(update={"worlds": (world,)})
    return task.model_copy(update={"teaching": teaching, "exam": exam})


class HomeOutcome(TaughtOutcome):
    """Robot that was taught at home."""

    lessons: int
    """Teaching events at home."""
    drive: DriveRow
    """Exam at home."""
    policy: DriveRow
    """Policy's own drive there."""


class TransferOutcome(TaughtOutcome):
    """Robot that was taught in a new world."""

    checkpoints: tuple[Checkpoint, ...]
    """Checkpoints in ascending order of presses."""
    policy: DriveRow
    """Policy's own drive in the new world."""
    home_when_right: DriveRow
    """Exam at home with the knowledge of the first exam passed in the new world, or without one of the end."""
    home: DriveRow
    """Exam at home at the end."""

    @property
    def judged(self) -> bool:
        """True if the exams in the new world have verdicts."""
        return self.checkpoints[0].judged

    @property
    def presses_until_right(self) -> float:
        """Smallest count of presses after which an exam in the new world was passed; infinite if none was."""
        return min((each.presses for each in self.checkpoints if each.passed), default=inf)

    @property
    def seconds_until_right(self) -> float:
        """Time of teaching up to that exam's knowledge, in s; infinite if no exam was passed, 0 without a press."""
        first = next((each for each in self.checkpoints if each.passed), None)
        return inf if first is None else first.teaching_s if first.presses else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeJob(StudyJob):
    """Lesson at home, and the exam there."""

    outcome = HomeOutcome
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True

    async def measure(self, knowledge: Path, report: Report) -> HomeOutcome:
        """Teach the robot at home into the file `knowledge`, examine it there and return the outcome."""
        lesson, events = await self.teach(knowledge, report)
        at_home = _examiner(self, self.task, report)
        policy = await at_home.drive_policy()
        return HomeOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=lesson.counts,
            lessons=len(events),
            drive=await at_home.examine(policy, events),
            policy=policy,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferJob(StudyJob):
    """Lesson in a new world, and exams there after some of its presses, and at home.

    The task is that of home.
    """

    outcome = TransferOutcome
    gives_exams: ClassVar[bool] = True
    teacher: str | None
    """Name of another teacher in the new world; None: the teacher of home."""
    place: str
    """Name of the new world, with SEED where it is another world for each robot."""
    after: tuple[int, ...]
    """Numbers of presses after which the robot is examined, ascending."""
    seconds: float
    """Longest time of teaching in the new world."""
    home: HomeJob
    """Job of an earlier wave, which taught the robot at home; its knowledge is copied."""

    async def measure(self, knowledge: Path, report: Report) -> TransferOutcome:
        """Teach on in the new world into the file `knowledge`, examine the robot and return the outcome.

        Raises StudyError without the result of home, and the errors of all jobs.
        """
        task = task_in(world_of(self.place, self.seed), self.task, self.teacher)
        copy_knowledge(self.home.knowledge, knowledge)
        known = len(read_lessons(knowledge, self.robot, task))
        # It ends before another press; a robot with knowledge is corrected from the beginning.
        plan = LessonPlan(((Phase.CORRECTIONS, self.seconds),), purpose=PURPOSE, most_presses=max(self.after))
        given = await self.teach(knowledge, report, task, plan)
        lesson, events = given
        there = _examiner(self, task, report)
        policy = await there.drive_policy()

        async def examine(events: Sequence[TeachingEvent], _labels: object) -> tuple[DriveRow, ...]:
            return (await there.examine(policy, events),)

        checkpoints = await run_checkpoints(given, self.after, self.robot.cycle_s, examine, known=known)
        at_end = checkpoints[-1].lessons
        when_right = next((each.lessons for each in checkpoints if each.passed), at_end)
        home = await self._drive_at_home(events[: known + at_end], report)
        return TransferOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=lesson.counts.model_copy(update={"presses": min(lesson.presses, max(self.after))}),
            checkpoints=tuple(checkpoints),
            policy=policy,
            home_when_right=home
            if when_right == at_end
            else await self._drive_at_home(events[: known + when_right], report),
            home=home,
        )

    async def _drive_at_home(self, events: Sequence[TeachingEvent], report: Report) -> DriveRow:
        """Examine the robot at home, unless it knows exactly what it knew when it was examined there."""
        before = self.results.read(self.home, HomeOutcome)
        if len(events) == before.lessons:
            return before.drive
        return await _examiner(self, self.task, report).examine(before.policy, events)


def _examiner(job: StudyJob, task: TaskSettings, report: Report) -> Examiner:
    """Return the examiner of a robot in the world that a task is taught in."""
    return Examiner(job.factory, job.robot, task, task.teaching.world, job.seed, report, job.engines.exams)


class NewWorlds(NamedTuple):
    """New worlds and the lessons there."""

    places: tuple[str, ...]
    """Names of worlds; SEED in a name stands for the robot's seed."""
    after: tuple[int, ...] = AFTER
    """Numbers of presses after which a robot is examined, ascending."""
    seconds: float | None = None
    """Longest time of teaching in s; None: that of the lesson at home."""
    teacher: str | None = None
    """Name of another teacher there; None: the teacher of home."""


class Transfer(NamedTuple):
    """Task that was taught at home, and when its robots are examined."""

    task: TaskSettings
    after: tuple[int, ...]
    """Numbers of presses after which a robot is examined in the new world, ascending."""


def make_plan(
    task: TaskSettings,
    new: NewWorlds,
    seeds: Sequence[int],
    parts: JobParts,
    *,
    engine: RequestedEngine = ALL_ON_BUS,
) -> StudyPlan[Transfer]:
    """Check task and worlds, and return the jobs.

    Args:
        task: to teach, in its own world and in the new ones.
        new: new worlds.
        seeds: one robot each.
        parts: factory, robot and results of the jobs.
        engine: requested for lessons and exams; lessons in new worlds are given on the CAN bus.

    Raises:
        config.settings.SettingsError: the task and a world do not fit, or a new world is that of home.
    """
    home, seconds = task.teaching.world, new.seconds or task.teaching.duration_s
    worlds = [world_of(place, seed) for place in new.places for seed in seeds]
    if home in worlds:
        raise SettingsError("is the world of home, not a new one", where=f"world {home}", do="name another one")
    require_places(parts["factory"], task, (home, *worlds))
    fingerprints, exam_s = Fingerprints(parts["factory"], parts["robot"]), task.exam.duration_s
    made_at_home = fingerprints.of(task, (home,))
    home_jobs = {
        seed: HomeJob(
            **parts,
            task=task,
            seed=seed,
            made_of=made_at_home,
            name=f"{task.name} at home, seed {seed}",
            stem=f"home/{task.name}-{seed}",
            robot_time_s=task.teaching.duration_s + 2 * exam_s,
        )
        for seed in seeds
    }

    def job(place: str, seed: int) -> TransferJob:
        world = world_of(place, seed)
        own = task_in(world, task, new.teacher).teaching.model_dump_json(serialize_as_any=True)
        file_name = re.sub(r"[^A-Za-z0-9_-]+", "-", Path(place).with_suffix("").as_posix()).strip("-")
        return TransferJob(
            **parts,
            task=task,
            seed=seed,
            made_of=fingerprints.of(task, (home, world), own, repr((new.after, seconds))),
            name=f"{task.name} in {world}, seed {seed}",
            stem=f"{file_name}/{task.name}-{seed}",
            robot_time_s=seconds + (len(new.after) + 3) * exam_s,
            wave=1,
            teacher=new.teacher,
            place=place,
            after=new.after,
            seconds=seconds,
            home=home_jobs[seed],
        )

    there = (job(place, seed) for place in dict.fromkeys(new.places) for seed in seeds)
    plan = StudyPlan(Transfer(task, new.after), tuple(seeds), (*home_jobs.values(), *there))
    return plan.driven(engine, parts["robot"])
