"""Jobs of the transfer study: a robot is taught at home, and then on in a new world."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.study.drive import Drive, Examiner
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.transfer.outcome import Checkpoint, HomeOutcome, TransferOutcome
from kurt2rt.experiments.transfer.variants import Variant
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons


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


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeJob(StudyJob):
    """Lesson at home, and the exam there."""

    outcome = HomeOutcome
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name} at home, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""
        return f"home/{self.task.name}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the lesson, the exam and the policy's drive in s."""
        return self.task.teaching.duration_s + 2 * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> HomeOutcome:
        """Teach the robot at home into the file `knowledge`, examine it there and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """
        lesson, events = await run_lesson(
            self.factory, self.robot, self.task, knowledge, seed=self.seed, report=report, loop=self.loops.lesson
        )
        at_home = _examiner(self, self.task, report)
        policy = await at_home.drive_policy()
        return HomeOutcome(
            made_of=self.made_of,
            seed=self.seed,
            presses=lesson.presses,
            lessons=len(events),
            rlas=len(lesson.rlas),
            knowledge_hash=lesson.knowledge_hash,
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
    world: str
    """Name of the new world."""
    place: str
    """Name of the kind of world, for file names."""
    after: tuple[int, ...]
    """Numbers of presses after which the robot is examined, ascending."""
    seconds: float
    """Longest time of teaching in the new world."""
    home: HomeJob
    """Job of an earlier wave, which taught the robot at home; its knowledge is copied."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name} in {self.world}, {self.variant.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""
        return f"{self.variant.name}/{self.place}/{self.task.name}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the lesson, the exams and the policy's drive in s, at most."""
        return self.seconds + (len(self.after) + 3) * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> TransferOutcome:
        """Teach on in the new world into the file `knowledge`, examine the robot and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError, and StudyError without the result of home.
        """
        task, known = self.variant.task(self.task, self.world), 0
        if self.variant.knows_home:
            copy_knowledge(self.home.knowledge, knowledge)
            known = len(read_lessons(knowledge, self.robot, task))
        plan = self.variant.plan(task, self.seconds, max(self.after))
        lesson, events = await run_lesson(
            self.factory, self.robot, task, knowledge, seed=self.seed, report=report, plan=plan
        )
        there = _examiner(self, task, report)
        policy = await there.drive_policy()
        checkpoints = await self._checkpoints(there, policy, lesson, events, known)
        when_right = next((each.lessons for each in checkpoints if each.drive.passed), checkpoints[-1].lessons)
        at_end = checkpoints[-1].lessons
        home = await self._drive_at_home(events[: known + at_end], report)
        return TransferOutcome(
            made_of=self.made_of,
            seed=self.seed,
            world=self.world,
            presses=min(lesson.presses, max(self.after)),
            asks=lesson.asks,
            corrections=lesson.corrections,
            collisions=lesson.collisions,
            rescues=lesson.rescues,
            teaching_s=lesson.teaching_s,
            rlas=len(lesson.rlas),
            knowledge_hash=lesson.knowledge_hash,
            checkpoints=tuple(checkpoints),
            policy=policy,
            home_when_right=home
            if when_right == at_end
            else await self._drive_at_home(events[: known + when_right], report),
            home=home,
        )

    async def _checkpoints(
        self, there: Examiner, policy: Drive, lesson: TrainingResult, events: Sequence[TeachingEvent], known: int
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

    async def _drive_at_home(self, events: Sequence[TeachingEvent], report: Report) -> Drive:
        """Examine the robot at home, unless it knows exactly what it knew when it was examined there."""
        before = self.results.read(self.home, HomeOutcome)
        if self.variant.knows_home and len(events) == before.lessons:
            return before.drive
        return await _examiner(self, self.task, report).examine(before.policy, events)


def _examiner(job: StudyJob, task: TaskSettings, report: Report) -> Examiner:
    """Return the examiner of a robot in the world that a task is taught in."""
    return Examiner(job.factory, job.robot, task, task.teaching.world, job.seed, report, job.loops.exams)
