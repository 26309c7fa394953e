"""Job of a comparison: lesson and exams of one robot that is one of the pupils."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from hal.batch_refusal import BatchRefusedError
from hal.settings import Settings
from kurt2rt.experiments.compare.lesson import LessonSetup, Mark, PupilLesson, give_lesson
from kurt2rt.experiments.compare.pupil import Pupil
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_loop import ON_BUS, DriveLoops
from kurt2rt.experiments.study.drive import Drive, Examiner
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.study.provenance import Provenance


class Checkpoint(Settings):
    """Exams with the knowledge after a number of presses."""

    presses: int
    """Presses asked for; a robot that gave cause for fewer has all that it was taught."""
    teaching_s: float
    """Time of teaching up to the first press that does not count, or to the end."""
    drives: tuple[Drive, ...]
    """One in each world in order, up to the first that failed."""

    @property
    def judged(self) -> bool:
        """True if a drive has a verdict."""
        return any(drive.judged for drive in self.drives)

    @property
    def passed(self) -> bool:
        """True if all drives with a verdict passed, and there is one."""
        return self.judged and all(drive.passed for drive in self.drives if drive.judged)


class PupilOutcome(Settings):
    """Lesson and exams of one robot that is one of the pupils."""

    made_of: Provenance
    seed: int
    presses: int
    asks: int
    corrections: int
    collisions: int
    """Collisions while it was taught."""
    alarms: int
    rescues: int
    failure: str
    """Failure of the learner in the lesson or an exam; empty without one."""
    checkpoints: tuple[Checkpoint, ...]
    """Checkpoints after the numbers of presses asked for, ascending; the last one is at the end of the lesson."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PupilJob(StudyJob):
    """Lesson of one robot by presses, and exams after some of them and at the end."""

    outcome = PupilOutcome
    keeps_knowledge: ClassVar[bool] = False
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True
    pupil: Pupil
    after: tuple[int, ...]
    """Numbers of presses after which the robot is examined, ascending."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, {self.pupil.title}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of the result, without the top folder and the ending."""
        return f"{self.pupil.label}/{self.task.name}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the lesson and of all exams in s, at most."""
        exams = (len(self.after) + 2) * len(self.task.exam.worlds)
        return self.task.teaching.duration_s + exams * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> PupilOutcome:  # noqa: ARG002 - a learner has no file
        """Teach and examine the robot, and return the outcome.

        Raises NoLearnerError, SettingsError, LessonLostError.
        """
        try:
            return await self._measure(self.loops, report)
        except BatchRefusedError:  # it does not know the task, or a learner failed
            return await self._measure(ON_BUS, report)

    async def _measure(self, loops: DriveLoops, report: Report) -> PupilOutcome:
        lesson = await give_lesson(self.factory, self._new_setup, loops.lesson, report)
        team, result = lesson.setup.team, lesson.result
        failures = [team.failure if team is not None else ""]
        checkpoints = await self._checkpoints(lesson, failures, loops, report)
        return PupilOutcome(
            made_of=self.made_of,
            seed=self.seed,
            presses=result.presses,
            asks=result.asks,
            corrections=result.corrections,
            collisions=result.collisions,
            alarms=result.alarms,
            rescues=result.rescues,
            failure=next(filter(None, failures), ""),
            checkpoints=tuple(checkpoints),
        )

    def _new_setup(self) -> LessonSetup:
        team = self.pupil.new_team(self.task, self.robot, self.seed)
        return LessonSetup(robot=self.robot, task=self.task, seed=self.seed, team=team, after=self.after)

    async def _checkpoints(
        self, lesson: PupilLesson, failures: list[str], loops: DriveLoops, report: Report
    ) -> list[Checkpoint]:
        """Examine the knowledge of each mark, and add failures of learners to `failures`."""
        examiners = [
            Examiner(self.factory, self.robot, self.task, world, self.seed, report, loops.exams)
            for world in self.task.exam.worlds
        ]
        policies = [await each.drive_policy() for each in examiners]
        checkpoints: list[Checkpoint] = []
        known: tuple[object, ...] = ()
        for mark in lesson.marks:
            if checkpoints and known == (mark.events, mark.labels):  # the same knowledge drives the same exams
                drives = checkpoints[-1].drives
            else:
                drives = await self._examine(mark, examiners, policies, failures)
            known = mark.events, mark.labels
            checkpoints.append(Checkpoint(presses=mark.presses, teaching_s=mark.teaching_s, drives=drives))
        return checkpoints

    async def _examine(
        self, mark: Mark, examiners: list[Examiner], policies: list[Drive], failures: list[str]
    ) -> tuple[Drive, ...]:
        """Return the drives in each world, up to the first that failed: one failure decides the success."""
        team = self.pupil.new_team(self.task, self.robot, self.seed)
        if team is not None:
            team.teach_all(mark.labels)
        drives: list[Drive] = []
        for examiner, policy in zip(examiners, policies, strict=True):
            drives.append(await examiner.examine(policy, mark.events, team))
            if team is not None:
                failures.append(team.failure)
            if drives[-1].judged and not drives[-1].passed:
                break
        return tuple(drives)
