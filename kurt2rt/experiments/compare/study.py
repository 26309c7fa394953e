"""Comparison of learners: every pupil is taught as every robot, task by task, and examined after some presses."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

from hal.batch import BatchRefusedError
from hal.settings import Settings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.compare.lesson import LessonSetup, Mark, PupilLesson, give_lesson
from kurt2rt.experiments.compare.pupil import SHIPPED, Pupil
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.engine import ON_BUS, Engines
from kurt2rt.experiments.lockstep.seed_result import counts_of
from kurt2rt.experiments.study.drive_row import DriveRow, Examiner
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import ALL_ON_BUS, RequestedEngine, StudyPlan


class Checkpoint(Settings):
    """Exams with the knowledge after a number of presses."""

    presses: int
    """Presses asked for; a robot that gave cause for fewer has all that it was taught."""
    teaching_s: float
    """Time of teaching up to the first press that does not count, or to the end."""
    drives: tuple[DriveRow, ...]
    """One in each world in order, up to the first that failed."""

    @property
    def judged(self) -> bool:
        """True if a drive has a verdict."""
        return any(drive.judged for drive in self.drives)

    @property
    def passed(self) -> bool:
        """True if all drives with a verdict passed, and there is one."""
        return self.judged and all(drive.passed for drive in self.drives if drive.judged)


class PupilOutcome(TaughtOutcome):
    """Lesson and exams of one robot that is one of the pupils."""

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

    async def measure(self, knowledge: Path, report: Report) -> PupilOutcome:  # noqa: ARG002 - a learner has no file
        """Teach and examine the robot, and return the outcome.

        Raises NoLearnerError, SettingsError, LessonLostError.
        """
        try:
            return await self._measure(self.engines, report)
        except BatchRefusedError:  # it does not know the task, or a learner failed
            return await self._measure(ON_BUS, report)

    async def _measure(self, engines: Engines, report: Report) -> PupilOutcome:
        lesson = await give_lesson(self.factory, self._new_setup, engines.lesson, report)
        team, result = lesson.setup.team, lesson.result
        failures = [team.failure if team is not None else ""]
        checkpoints = await self._checkpoints(lesson, failures, engines, report)
        return PupilOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=counts_of(result),
            failure=next(filter(None, failures), ""),
            checkpoints=tuple(checkpoints),
        )

    def _new_setup(self) -> LessonSetup:
        team = self.pupil.new_team(self.task, self.robot, self.seed)
        return LessonSetup(robot=self.robot, task=self.task, seed=self.seed, team=team, after=self.after)

    async def _checkpoints(
        self, lesson: PupilLesson, failures: list[str], engines: Engines, report: Report
    ) -> list[Checkpoint]:
        """Examine the knowledge of each mark, and add failures of learners to `failures`."""
        examiners = [
            Examiner(self.factory, self.robot, self.task, world, self.seed, report, engines.exams)
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
        self, mark: Mark, examiners: list[Examiner], policies: list[DriveRow], failures: list[str]
    ) -> tuple[DriveRow, ...]:
        """Return the drives in each world, up to the first that failed: one failure decides the success."""
        team = self.pupil.new_team(self.task, self.robot, self.seed)
        if team is not None:
            team.teach_all(mark.labels)
        drives: list[DriveRow] = []
        for examiner, policy in zip(examiners, policies, strict=True):
            drives.append(await examiner.examine(policy, mark.events, team))
            if team is not None:
                failures.append(team.failure)
            if drives[-1].judged and not drives[-1].passed:
                break
        return tuple(drives)


class Compared(NamedTuple):
    """Tasks that are taught, and when their robots are examined."""

    tasks: tuple[TaskSettings, ...]
    after: tuple[int, ...]
    """Numbers of presses after which the robots are examined, besides the end, ascending."""


def make_plan(
    tasks: Sequence[TaskSettings],
    pupils: Sequence[Pupil],
    seeds: Sequence[int],
    after: Sequence[int],
    parts: JobParts,
    *,
    engine: RequestedEngine = ALL_ON_BUS,
) -> StudyPlan[Compared]:
    """Check tasks and worlds, and return the jobs.

    Args:
        tasks: to teach, with their teachers.
        pupils: to compare; the RLA system as shipped is added, because all others are compared with it.
        seeds: one robot each.
        after: numbers of presses after which the robots are examined, ascending.
        parts: factory, robot and results of the jobs.
        engine: requested for lessons and exams.

    Raises:
        hal.settings.SettingsError: a task and a world do not fit.
        NoLearnerError: there is no such learner.
    """
    about = Compared(tuple(tasks), tuple(after))
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    jobs = []
    for task in tasks:
        worlds = (task.teaching.world, *task.exam.worlds)
        require_places(parts["factory"], task, worlds)
        exams = (len(after) + 2) * len(task.exam.worlds)
        for pupil in dict.fromkeys((Pupil(SHIPPED), *pupils)):
            made = fingerprints.of(task, worlds, repr(about.after), learner=pupil.source)
            jobs += [
                PupilJob(
                    **parts,
                    task=task,
                    seed=seed,
                    made_of=made,
                    name=f"{task.name}, {pupil.title}, seed {seed}",
                    stem=f"{pupil.label}/{task.name}-{seed}",
                    robot_time_s=task.teaching.duration_s + exams * task.exam.duration_s,
                    pupil=pupil,
                    after=about.after,
                )
                for seed in seeds
            ]
    return StudyPlan(about, tuple(seeds), tuple(jobs)).driven(engine, parts["robot"])
