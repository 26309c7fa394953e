"""Comparison of learners: every pupil is taught as every robot, task by task, and examined after some presses."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import ClassVar, NamedTuple

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner import Label
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.learner.learners import NoLearnerError, find_learner, source_of_learner
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import ON_BUS
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.study.examination import Checkpoint, Examiner, run_checkpoints
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import EngineRequest, StudyPlan
from kurt2rt.knowledge.files.archive_existing import archive_existing
from simbridge.contracts.batch import BatchRefusedError

SHIPPED = "rla"
"""Name of the RLA system with the task's own settings, with which all others are compared."""
PUPILS = (SHIPPED, "1-nn", "k-nn", "weighted-vote", "svm", "tree")
"""Names of those that are compared unless others are named."""
_TITLES = {
    SHIPPED: "RLA, as shipped",
    "rla-door": "RLA through the door",
    "1-nn": "1-NN without R",
    "k-nn": "5-NN with R",
    "weighted-vote": "locally weighted vote with R",
    "svm": "RBF-SVM, margin gate",
    "tree": "decision tree, refitted",
}


@dataclass(frozen=True, slots=True)
class Pupil:
    """Learner that a study compares: the RLA system, or another one by name, with its gate."""

    name: str
    """`SHIPPED`, or the name of a learner."""
    gate: float | None = None
    """Number by which a learner asks, of its own unit; None: its default."""

    @classmethod
    def parse(cls, text: str) -> "Pupil":
        """Return the pupil of a text: a name, or NAME=GATE. Raises NoLearnerError."""
        name, equals, gate = text.partition("=")
        try:
            pupil = cls(name, float(gate) if equals else None)
        except ValueError as error:
            raise NoLearnerError(
                f"{gate!r} is not a number", where=f"learner {name}", do="give NAME=GATE, such as k-nn=0.8"
            ) from error
        if pupil.is_learner:
            find_learner(name)
        elif equals:
            raise NoLearnerError("has no gate", where=f"learner {name}", do="give its name alone")
        return pupil

    @property
    def is_learner(self) -> bool:
        """Return whether it is taught through the door, and not by the RLA level of the robot."""
        return self.name != SHIPPED

    @property
    def title(self) -> str:
        """Name in tables, with a gate that is not the default."""
        title = _TITLES.get(self.name, self.name)
        return title if self.gate is None else f"{title} ({self.gate:g})"

    @property
    def label(self) -> str:
        """Name that file names can hold, such as k-nn-gate-0.8."""
        name = self.name.replace(":", ".")
        return name if self.gate is None else f"{name}-gate-{self.gate:g}"

    @property
    def source(self) -> str:
        """Text that changes with all that decides its results, besides the program. Raises NoLearnerError."""
        if not self.is_learner:
            return self.label
        return f"{self.label} {source_of_learner(self.name)} scikit-learn {version('scikit-learn')}"

    def new_team(self, task: TaskSettings, robot: RobotSettings, seed: int) -> LearnerTeam | None:
        """Return learners of all behaviours of the task that know nothing; None for the RLA system.

        Raises NoLearnerError, and config.settings.SettingsError for settings that do not fit each other.
        """
        if not self.is_learner:
            return None
        setting = learner_setting(task, robot, seed=seed, gate=self.gate)
        return LearnerTeam(self.name, find_learner(self.name), setting, task.behaviours)


class PupilOutcome(TaughtOutcome):
    """Result of one robot with one learner: its lesson, and its exams at the checkpoints."""

    failure: str
    """Failure of the learner in the lesson or an exam; empty without one."""
    checkpoints: tuple[Checkpoint, ...]
    """Checkpoints after the numbers of presses asked for, ascending; the last one is at the end of the lesson."""

    @property
    def end(self) -> Checkpoint:
        """Checkpoint at the end of the lesson."""
        return self.checkpoints[-1]


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
        team = self.pupil.new_team(self.task, self.robot, self.seed)
        given = await self.teach(knowledge, report, learners=team)
        failures = [team.failure if team is not None else ""]
        examiners = [Examiner(self, self.task, world, report) for world in self.task.exam.worlds]
        policies = [await each.drive_policy() for each in examiners]

        async def examine(events: Sequence[TeachingEvent], labels: Sequence[Label]) -> tuple[DriveRow, ...]:
            """Return the drives in each world, up to the first that failed: one failure decides the success."""
            team = self.pupil.new_team(self.task, self.robot, self.seed)
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
    engine: EngineRequest = EngineRequest.CAN,
) -> StudyPlan[Compared]:
    """Check tasks and worlds, and return the jobs, a robot for each seed, task and pupil.

    The RLA system as shipped is added to `pupils`, because all others are compared with it. `after`: numbers of presses
    after which the robots are examined, ascending. Raises config.settings.SettingsError, NoLearnerError.
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
