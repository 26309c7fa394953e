"""Exams of taught robots by the policy's own drives: of a knowledge file, and at checkpoints of a lesson."""

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import anyio

from config.settings import Settings
from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner import Label
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import with_own_route
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives, run_exams
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.faulty_sensor import parse_break
from kurt2rt.experiments.lockstep.lesson import GivenLesson
from kurt2rt.experiments.study.jobs import StudyJob, require_places
from kurt2rt.knowledge.journal.loading import read_lessons
from simbridge.contracts.robot_kind import simulations_of

Examine = Callable[[Sequence[TeachingEvent], Sequence[Label]], Awaitable[tuple[DriveRow, ...]]]
"""Examines the knowledge of RLAs and, if learners were taught in their place, of learners."""


def examine_file(
    knowledge: Path,
    robot: RobotSettings,
    task: TaskSettings,
    seed: int,
    report: Report,
    *,
    worlds: Sequence[str] = (),
    broken: str | None = None,
) -> tuple[DriveRow, ...]:
    """Examine the robot of a knowledge file in each world, next to its teacher's policy; return the drives in order.

    `task`: a route that names no seed is that of this robot. `worlds`: empty: those of the task. `broken`: sensor that
    breaks and the way in which, such as s15=low; None: all work. Raises KnowledgeError, SettingsError, LessonLostError.
    """
    task, stage = with_own_route(task, seed), simulations_of(robot)
    worlds = tuple(worlds) or task.exam.worlds
    require_places(stage, task, worlds)
    events = read_lessons(knowledge, robot, task)
    sensor = None if broken is None else parse_break(broken, robot.infrared)
    return anyio.run(partial(run_exams, stage, robot, task, events, worlds, seed=seed, report=report, broken=sensor))


@dataclass(frozen=True, slots=True)
class Examiner:
    """Examiner of one robot in one world, by the policy's own drive from the same start."""

    job: StudyJob
    task: TaskSettings
    world: str
    report: Report

    async def drive_policy(self) -> DriveRow:
        """Return the policy's own drive; it passes if it has no collision, alarm or standstill.

        Raises SettingsError if task and world do not fit.
        """
        policy = await self._drive(ExamSetup(self.world, self.job.seed, teacher_policy=True))
        return policy.judged_by(policy.progress, self.task.exam.success)

    async def examine(
        self, policy: DriveRow, events: Sequence[TeachingEvent], learners: LearnerTeam | None = None
    ) -> DriveRow:
        """Return the drive of a taught robot, judged by the policy's drive; learners decide in place of RLAs if given.

        A world in which the policy itself does not pass is no measure, and the drive is not judged. Raises
        SettingsError if task and world do not fit, LessonLostError if the robot refused a command.
        """
        exam = await self._drive(ExamSetup(self.world, self.job.seed, events=events, learners=learners))
        return exam.judged_by(policy.progress, self.task.exam.success) if policy.passed else exam

    async def _drive(self, setup: ExamSetup) -> DriveRow:
        job = self.job
        (result,) = await run_drives(job.factory, job.robot, self.task, [setup], self.report, job.engines.exams)
        return result.stored()


class Checkpoint(Settings):
    """Exams of a robot with what it knew after a number of presses of its lesson."""

    presses: int
    """Presses asked for; a robot that gave cause for fewer has all that it was taught."""
    teaching_s: float
    """Time of teaching up to the first press that does not count, or to the end."""
    lessons: int
    """Teaching events of the lesson so far, undos included."""
    drives: tuple[DriveRow, ...]
    """Exams in each world in order, up to the first that failed."""

    @property
    def judged(self) -> bool:
        """True if a drive has a verdict."""
        return any(drive.judged for drive in self.drives)

    @property
    def passed(self) -> bool:
        """True if all drives with a verdict passed, and there is one."""
        return self.judged and all(drive.passed for drive in self.drives if drive.judged)


async def run_checkpoints(
    given: GivenLesson, after: Sequence[int], period_s: float, examine: Examine, *, known: int = 0
) -> list[Checkpoint]:
    """Examine the knowledge after each of these numbers of presses; equal knowledge is examined once.

    `given`: lesson with all events that its file then holds, of which `known` came before it. `after`: ascending.
    `period_s`: of a tick.
    """
    lesson, events = given
    checkpoints: list[Checkpoint] = []
    before: tuple[int, ...] = ()
    ticks = lesson.press_ticks
    for presses in after:
        lessons = events_before_press(events[known:], ticks, presses)
        labels = lesson.labels[min(presses, len(lesson.labels) - 1)] if lesson.labels else ()
        now = (lessons, *map(id, labels))
        drives = checkpoints[-1].drives if now == before else await examine(events[: known + lessons], labels)
        taught_s = ticks[presses] * period_s if presses < len(ticks) else lesson.counts.teaching_s
        checkpoints.append(Checkpoint(presses=presses, teaching_s=taught_s, lessons=lessons, drives=drives))
        before = now
    return checkpoints


def events_before_press(events: Sequence[TeachingEvent], press_ticks: Sequence[int], presses: int) -> int:
    """Return how many events of a lesson were applied before the press that follows `presses` others.

    A hold teaches until its release, and so all lessons of a press come before the next press. `press_ticks`: tick in
    which each press was sent; the robot applies it in a later tick.
    """
    if presses >= len(press_ticks):
        return len(events)
    return sum(event.origin.tick <= press_ticks[presses] for event in events)
