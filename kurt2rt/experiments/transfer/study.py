"""Transfer study: each robot is taught at home, and then on in new worlds, by each variant of teaching."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import ClassVar, NamedTuple

from hal.settings import Settings, SettingsError
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.lockstep.seed_result import counts_of
from kurt2rt.experiments.study.drive_row import DriveRow, Examiner
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places, world_of
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import ALL_ON_BUS, RequestedEngine, StudyPlan
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons

AFTER = (0, 2, 5, 10, 15, 20)
"""Numbers of presses after which a robot is examined."""
PURPOSE = "new-world"
"""Purpose of the simulation in which a robot is taught on: another start and other noise than at home."""


@dataclass(frozen=True, slots=True)
class Variant:
    """Variant of teaching in a new world."""

    name: str
    """Name in file names."""
    title: str
    teacher: str | None = None
    """Name of another teacher in the new world; None: the teacher of home."""
    knows_home: bool = True
    """False: the robot begins in the new world without any knowledge."""

    def task(self, task: TaskSettings, world: str) -> TaskSettings:
        """Return the task to teach and examine in a new world, by its name.

        Raises hal.settings.SettingsError if the teacher cannot be loaded.
        """
        if self.teacher is not None:
            task = taught_by(task, load_teacher(self.teacher))
        teaching = task.teaching.model_copy(update={"world": world})
        exam = task.exam.model_copy(update={"worlds": (world,)})
        return task.model_copy(update={"teaching": teaching, "exam": exam})

    def plan(self, task: TaskSettings, seconds: float, most_presses: int) -> LessonPlan:
        """Return the plan of the lesson in the new world, which ends at `seconds` s or before another press.

        A robot with knowledge is corrected from the beginning; without knowledge it goes through phase 1 first.
        """
        supervised_s = 0.0 if self.knows_home else min(task.teaching.supervised_s, seconds)
        phases = ((Phase.SUPERVISED, supervised_s), (Phase.CORRECTIONS, seconds - supervised_s))
        return LessonPlan(tuple(each for each in phases if each[1]), purpose=PURPOSE, most_presses=most_presses)


TAUGHT_ON = Variant("taught-on", "home knowledge, taught on")
"""Variant that is studied."""
CONTROLS = (
    Variant("answers-only", "control: questions are answered, nothing is corrected", teacher="answers_only"),
    Variant("from-nothing", "control: without the knowledge of home", knows_home=False),
)


def taught_on_by(teacher: str | None) -> Variant:
    """Return the variant that is studied, with this teacher in the new world; None: the teacher of home."""
    if teacher is None:
        return TAUGHT_ON
    return replace(TAUGHT_ON, title=f"{TAUGHT_ON.title} by {Path(teacher).stem}", teacher=teacher)


class Checkpoint(Settings):
    """Knowledge after a number of presses in the new world, and its exam there."""

    presses: int
    """Presses asked for; a robot that gave cause for fewer has all that it was taught."""
    teaching_s: float
    """Time of teaching up to the first press that does not count, or to the end."""
    lessons: int
    """Teaching events in the new world so far, undos included."""
    drive: DriveRow


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
        return self.checkpoints[0].drive.judged

    @property
    def presses_until_right(self) -> float:
        """Smallest count of presses after which an exam in the new world was passed; infinite if none was."""
        return min((each.presses for each in self.checkpoints if each.drive.passed), default=inf)

    @property
    def seconds_until_right(self) -> float:
        """Time of teaching up to that exam's knowledge, in s; infinite if no exam was passed, 0 without a press."""
        first = next((each for each in self.checkpoints if each.drive.passed), None)
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
            lesson=counts_of(lesson),
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
    variant: Variant
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
        task, known = self.variant.task(self.task, world_of(self.place, self.seed)), 0
        if self.variant.knows_home:
            copy_knowledge(self.home.knowledge, knowledge)
            known = len(read_lessons(knowledge, self.robot, task))
        plan = self.variant.plan(task, self.seconds, max(self.after))
        lesson, events = await self.teach(knowledge, report, task, plan)
        there = _examiner(self, task, report)
        policy = await there.drive_policy()
        checkpoints = await self._checkpoints(there, policy, lesson, events, known)
        at_end = checkpoints[-1].lessons
        when_right = next((each.lessons for each in checkpoints if each.drive.passed), at_end)
        home = await self._drive_at_home(events[: known + at_end], report)
        return TransferOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=counts_of(lesson).model_copy(update={"presses": min(lesson.presses, max(self.after))}),
            checkpoints=tuple(checkpoints),
            policy=policy,
            home_when_right=home
            if when_right == at_end
            else await self._drive_at_home(events[: known + when_right], report),
            home=home,
        )

    async def _checkpoints(
        self, there: Examiner, policy: DriveRow, lesson: TrainingResult, events: Sequence[TeachingEvent], known: int
    ) -> list[Checkpoint]:
        """Examine the robot in the new world after each number of presses; `known`: number of events of home."""
        checkpoints: list[Checkpoint] = []
        ticks = lesson.press_ticks
        for presses in self.after:
            lessons = events_before_press(events[known:], ticks, presses)
            if checkpoints and checkpoints[-1].lessons == lessons:  # the same knowledge drives the same exam
                drive = checkpoints[-1].drive
            else:
                drive = await there.examine(policy, events[: known + lessons])
            taught_s = ticks[presses] * self.robot.cycle_s if presses < len(ticks) else lesson.teaching_s
            checkpoints.append(Checkpoint(presses=presses, teaching_s=taught_s, lessons=lessons, drive=drive))
        return checkpoints

    async def _drive_at_home(self, events: Sequence[TeachingEvent], report: Report) -> DriveRow:
        """Examine the robot at home, unless it knows exactly what it knew when it was examined there."""
        before = self.results.read(self.home, HomeOutcome)
        if self.variant.knows_home and len(events) == before.lessons:
            return before.drive
        return await _examiner(self, self.task, report).examine(before.policy, events)


def _examiner(job: StudyJob, task: TaskSettings, report: Report) -> Examiner:
    """Return the examiner of a robot in the world that a task is taught in."""
    return Examiner(job.factory, job.robot, task, task.teaching.world, job.seed, report, job.engines.exams)


def events_before_press(events: Sequence[TeachingEvent], press_ticks: Sequence[int], presses: int) -> int:
    """Return how many events of a lesson were applied before the press that follows `presses` others.

    A hold teaches until its release, and so all lessons of a press come before the next press.

    Args:
        events: of the lesson alone, in order.
        press_ticks: tick in which each press of the lesson was sent; the robot applies it in a later tick.
        presses: number of presses that count.
    """
    if presses >= len(press_ticks):
        return len(events)
    return sum(event.origin.tick <= press_ticks[presses] for event in events)


class NewWorlds(NamedTuple):
    """New worlds and the lessons there."""

    places: tuple[str, ...]
    """Names of worlds; SEED in a name stands for the robot's seed."""
    after: tuple[int, ...] = AFTER
    """Numbers of presses after which a robot is examined, ascending."""
    seconds: float | None = None
    """Longest time of teaching in s; None: that of the lesson at home."""


class Transfer(NamedTuple):
    """Task that was taught at home, and when its robots are examined."""

    task: TaskSettings
    after: tuple[int, ...]
    """Numbers of presses after which a robot is examined in the new world, ascending."""


def make_plan(
    task: TaskSettings,
    new: NewWorlds,
    seeds: Sequence[int],
    variants: Sequence[Variant],
    parts: JobParts,
    *,
    engine: RequestedEngine = ALL_ON_BUS,
) -> StudyPlan[Transfer]:
    """Check task and worlds, and return the jobs.

    Args:
        task: to teach, in its own world and in the new ones.
        new: new worlds.
        seeds: one robot each.
        variants: ways of teaching in the new worlds.
        parts: factory, robot and results of the jobs.
        engine: requested for lessons and exams; lessons in new worlds are given on the CAN bus.

    Raises:
        hal.settings.SettingsError: the task and a world do not fit, or a new world is that of home.
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

    def job(place: str, variant: Variant, seed: int) -> TransferJob:
        world = world_of(place, seed)
        own = variant.task(task, world).teaching.model_dump_json(serialize_as_any=True)
        file_name = re.sub(r"[^A-Za-z0-9_-]+", "-", Path(place).with_suffix("").as_posix()).strip("-")
        return TransferJob(
            **parts,
            task=task,
            seed=seed,
            made_of=fingerprints.of(task, (home, world), own, repr((variant, new.after, seconds))),
            name=f"{task.name} in {world}, {variant.name}, seed {seed}",
            stem=f"{variant.name}/{file_name}/{task.name}-{seed}",
            robot_time_s=seconds + (len(new.after) + 3) * exam_s,
            wave=1,
            variant=variant,
            place=place,
            after=new.after,
            seconds=seconds,
            home=home_jobs[seed],
        )

    there = (job(place, variant, seed) for place in dict.fromkeys(new.places) for variant in variants for seed in seeds)
    plan = StudyPlan(Transfer(task, new.after), tuple(seeds), (*home_jobs.values(), *there))
    return plan.driven(engine, parts["robot"])
