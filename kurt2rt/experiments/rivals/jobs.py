"""Jobs of a league: drives of the policy, and lesson and exams of one robot with one rival."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from hal.robot_settings import RobotSettings
from hal.simulation import Simulation
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.learner.learner import OWN, Label, LearnerFactory, Signal
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.learner.packing import pack
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_exam import BatchExam
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop, DriveLoops
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.rivals.following import followed_by_rlas
from kurt2rt.experiments.rivals.learner_clock import LearnerClock
from kurt2rt.experiments.rivals.lesson import (
    OnProgress,
    RivalLesson,
    RivalSetup,
    give_lesson,
    in_batch_or_on_bus,
    teach_rival,
)
from kurt2rt.experiments.rivals.marks import Mark
from kurt2rt.experiments.rivals.outcome import PolicyOutcome, RivalCheckpoint, RivalOutcome
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.rivals.undo import Undo, undo_of_learner, undo_of_rlas
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.transfer.jobs import verdict_by
from kurt2rt.experiments.transfer.outcome import Drive, drive_of
from kurt2rt.runtime import empty_system


@dataclass(frozen=True, slots=True, kw_only=True)
class PolicyJob(StudyJob):
    """Drives of the teacher's own policy in all worlds of the exam."""

    outcome = PolicyOutcome
    keeps_knowledge: ClassVar[bool] = False
    gives_exams: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, policy, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of the result, without the top folder and the ending."""
        return f"policy/{self.task.name}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of all drives in s."""
        return len(self.task.exam.worlds) * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> PolicyOutcome:  # noqa: ARG002 - nothing is taught
        """Let the policy drive, and return the outcome. Raises SettingsError if task and world do not fit."""
        exams = [BatchExam(ExamSetup(world, self.seed, teacher_policy=True)) for world in self.task.exam.worlds]
        drives = tuple(
            drive_of(each, each.verdict(each.progress, self.task.exam.success))
            for each in await run_drives(self.factory, self.robot, self.task, exams, report, self.loops.exams)
        )
        return PolicyOutcome(made_of=self.made_of, seed=self.seed, drives=drives)


@dataclass(frozen=True, slots=True, kw_only=True)
class RivalJob(StudyJob):
    """Lesson of one robot with one rival by presses, and exams after some of them and at the end."""

    outcome = RivalOutcome
    keeps_knowledge: ClassVar[bool] = False
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True
    machine_times: ClassVar[frozenset[str]] = frozenset(
        ("retraining_s", "longest_decision_ms", "tick_p99_us", "undo_s")
    )
    rival: Rival
    after: tuple[int, ...]
    """Numbers of presses after which the robot is examined, ascending."""
    policy: PolicyJob
    """Job of the wave before, whose drives judge this one's."""

    @classmethod
    def require(cls, rival: Rival, task: TaskSettings, robot: RobotSettings) -> None:
        """Check that such a job can be done, before any is; a subclass may refuse.

        Raises NoLearnerError, and hal.settings.SettingsError.
        """

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, {self.rival.title}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of the result, without the top folder and the ending."""
        return f"{self.rival.label}/{self.task.name}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the lesson and of all exams in s, at most."""
        exams = (len(self.after) + 1) * len(self.task.exam.worlds)
        return self.task.teaching.duration_s + exams * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> RivalOutcome:  # noqa: ARG002 - a learner has no file
        """Teach and examine the robot, and return the outcome.

        Raises NoLearnerError, SettingsError, LessonLostError, and StudyError without the drives of the policy.
        """
        return await in_batch_or_on_bus(lambda loops: self._measure(loops, report), self.loops)

    async def _measure(self, loops: DriveLoops, report: Report) -> RivalOutcome:
        clock = LearnerClock()
        lesson = await self._teach(loops.lesson, clock, report)
        team = lesson.setup.team
        failures = [team.failure if team is not None else ""]
        checkpoints = await self._checkpoints(lesson.marks, clock, failures, loops.exams, report)
        result = lesson.result
        undo = self._undo(lesson)
        return RivalOutcome(
            made_of=self.made_of,
            seed=self.seed,
            presses=result.presses,
            labels=len(lesson.marks[-1].events) if team is None else _labels_by_teacher(lesson.marks[-1].lessons),
            driven_s=lesson.driven_s,
            waited_s=lesson.waited_s,
            asks=result.asks,
            corrections=result.corrections,
            collisions=result.collisions,
            alarms=result.alarms,
            rescues=result.rescues,
            teaching_s=result.teaching_s,
            failure=next(filter(None, failures), ""),
            checkpoints=tuple(checkpoints),
            knowledge_bytes=_rla_bytes(lesson) if team is None else sum(map(len, team.snapshot().values())),
            retraining_s=clock.retraining_s,
            longest_decision_ms=clock.longest_ms,
            tick_p99_us=result.ledger.tick().p99_us if result.ledger.ticks else None,
            undo_s=undo.seconds,
            undo_restores=undo.restores,
            change_ticks=lesson.change_ticks,
            followed_share=self._followed_share(lesson, clock),
        )

    async def _teach(self, loop: DriveLoop, clock: LearnerClock, report: Report) -> RivalLesson:
        def new_setup() -> RivalSetup:
            clock.restart()
            team = self._new_team(clock)
            return RivalSetup(robot=self.robot, task=self.task, seed=self.seed, team=team, after=self.after)

        async def on_bus(simulation: Simulation, setup: RivalSetup, on_progress: OnProgress) -> RivalLesson:
            return await self._teach_on_bus(simulation, setup, clock, on_progress)

        return await give_lesson(self.factory, new_setup, loop, report, on_bus)

    async def _teach_on_bus(
        self,
        simulation: Simulation,
        setup: RivalSetup,
        clock: LearnerClock,  # noqa: ARG002 - for other teachers
        on_progress: OnProgress,
    ) -> RivalLesson:
        """Give the lesson over the CAN bus; a subclass has another teacher."""
        return await teach_rival(simulation, setup, on_progress)

    def _new_team(self, clock: LearnerClock) -> LearnerTeam | None:
        if not self.rival.is_learner:
            return None
        return self._team_of(clock.timed(self.rival.factory()))

    def _team_of(self, make: LearnerFactory) -> LearnerTeam:
        """Return learners that know nothing; a subclass has another team."""
        return self.rival.new_team(self.task, self.robot, self.seed, make)

    async def _checkpoints(
        self, marks: Sequence[Mark], clock: LearnerClock, failures: list[str], loop: DriveLoop, report: Report
    ) -> list[RivalCheckpoint]:
        """Examine the knowledge of each mark, and add failures of learners to `failures`."""
        policies = self.results.read(self.policy, PolicyOutcome).drives
        checkpoints: list[RivalCheckpoint] = []
        for place, mark in enumerate(marks):
            before = marks[place - 1] if place else None
            if before is not None and (before.events, before.lessons) == (mark.events, mark.lessons):
                drives = checkpoints[-1].drives
            else:
                drives = await self._examine(mark, policies, clock, failures, loop, report)
            checkpoints.append(RivalCheckpoint(presses=mark.presses, teaching_s=mark.teaching_s, drives=drives))
        return checkpoints

    async def _examine(
        self,
        mark: Mark,
        policies: Sequence[Drive],
        clock: LearnerClock,
        failures: list[str],
        loop: DriveLoop,
        report: Report,
    ) -> tuple[Drive, ...]:
        team = self._new_team(clock)
        if team is not None:
            team.teach_all(mark.lessons)
        return await self._drives(team, mark.events, policies, failures, loop, report)

    async def _drives(
        self,
        team: LearnerTeam | None,
        events: Sequence[TeachingEvent],
        policies: Sequence[Drive],
        failures: list[str],
        loop: DriveLoop,
        report: Report,
    ) -> tuple[Drive, ...]:
        """Return the drives in each world, up to the first that failed: one failure decides the success."""
        task = self.rival.examined(self.task)
        drives: list[Drive] = []
        for world, policy in zip(task.exam.worlds, policies, strict=True):
            setup = ExamSetup(world, self.seed, learners=team)
            exams = [BatchExam(setup, events)]
            (exam,) = await run_drives(self.factory, self.robot, task, exams, report, loop)
            drives.append(drive_of(exam, verdict_by(policy, exam, task.exam.success)))
            if team is not None:
                failures.append(team.failure)
            if drives[-1].judged and not drives[-1].passed:
                break
        return tuple(drives)

    def _undo(self, lesson: RivalLesson) -> Undo:
        team = lesson.setup.team
        if team is not None:
            other = self._new_team(LearnerClock())
            assert other is not None
            return undo_of_learner(team, other)
        return undo_of_rlas(lesson.runtime.level.system, self._empty_system(lesson), lesson.marks[-1].events)

    def _followed_share(self, lesson: RivalLesson, clock: LearnerClock) -> float | None:
        if lesson.setup.team is not None:
            return clock.followed / clock.lessons if clock.lessons else None
        return followed_by_rlas(self._empty_system(lesson), lesson.marks[-1].events)

    def _empty_system(self, lesson: RivalLesson) -> RlaSystem:
        mid = None if self.task.mid is None else load_mid_level(self.task.mid)
        return empty_system(self.task, lesson.runtime.definition, load_critic(self.task.critic), mid)


def _labels_by_teacher(lessons: Sequence[Label | Signal]) -> int:
    return sum(isinstance(each, Signal) or each.why not in OWN for each in lessons)


def _rla_bytes(lesson: RivalLesson) -> int:
    """Return the size of conditions and actions of the RLAs, packed as the labels of learners are."""
    rlas = lesson.result.rlas
    return len(pack(np.array([rla.condition for rla in rlas]), [rla.action for rla in rlas])) if rlas else 0
