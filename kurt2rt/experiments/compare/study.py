"""Comparison of learners: every pupil is taught as every robot, task by task, and examined after some presses."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, NamedTuple

from kurt2rt.core.learner.learner import Label
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.compare.pupil import SHIPPED, Pupil
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import ON_BUS
from kurt2rt.experiments.study.checkpoints import Checkpoint, run_checkpoints
from kurt2rt.experiments.study.examiner import Examiner
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import ALL_ON_BUS, RequestedEngine, StudyPlan
from kurt2rt.knowledge.files.archive_existing import archive_existing
from simbridge.contracts.batch import BatchRefusedError


class PupilOutcome(TaughtOutcome):
    """Result of one robot with one learner: its lesson, and its exams at the checkpoints."""

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

    async def measure(self, knowledge: Path, report: Report) -> PupilOutcome:
        """Teach and examine the robot, and return the outcome; `knowledge` is the file to teach into.

        Raises NoLearnerError, SettingsError, LessonLostError.
        """
        try:
            return await self._measure(knowledge, report)
        except BatchRefusedError:  # it does not know the task, or a learner failed
            archive_existing(knowledge)
            return await replace(self, engines=ON_BUS)._measure(knowledge, report)

    async def _measure(self, knowledge: Path, report: Report) -> PupilOutcome:
        team = self._new_team()
        given = await self.teach(knowledge, report, learners=team)
        failures = [team.failure if team is not None else ""]
        examiners = [
            Examiner(self.factory, self.robot, self.task, world, self.seed, report, self.engines.exams)
            for world in self.task.exam.worlds
        ]
        policies = [await each.drive_policy() for each in examiners]

        async def examine(events: Sequence[TeachingEvent], labels: Sequence[Label]) -> tuple[DriveRow, ...]:
            """Return the drives in each world, up to the first that failed: one failure decides the success."""
            team = self._new_team()
            if team is not None:
                team.teach_all(labels)
            drives: list[DriveRow] = []
            for examiner, policy in zip(examiners, policies, strict=True):
                drives.append(await examiner.examine(policy, events, team))
                if team is not None:
                    failures.append(team.failure)
                if drives[-1].judged and not drives[-1].passed:
                    break
            return tuple(drives)

        after = (*self.after, given.result.presses)
        return PupilOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=given.result.counts,
            checkpoints=tuple(await run_checkpoints(given, after, self.robot.cycle_s, examine)),
            failure=next(filter(None, failures), ""),
        )

    def _new_team(self) -> LearnerTeam | None:
        return self.pupil.new_team(self.task, self.robot, self.seed)


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
        config.settings.SettingsError: a task and a world do not fit.
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
