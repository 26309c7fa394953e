"""Jobs of a study: drives of one robot in simulated time, with a stored result."""

from abc import abstractmethod
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypedDict

import anyio

from config.settings import Settings
from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.experiments.lockstep.curriculum import Report, run_exams, run_lesson
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import ON_BUS, Engine, Engines
from kurt2rt.experiments.lockstep.lesson import GivenLesson, LessonCounts
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.study.results import Outcome, Progress, Results, StoredJob
from simbridge.contracts.simulation import SimulationFactory

SEED = "SEED"
"""Part of a world's name that stands for a robot's seed."""


class JobParts(TypedDict):
    """Fields that all jobs of a study share."""

    factory: SimulationFactory
    robot: RobotSettings
    results: Results


class TaughtOutcome(Outcome):
    """Stored outcome of a robot that was taught."""

    lesson: LessonCounts


class ExaminedOutcome(TaughtOutcome):
    """Stored outcome of a robot that was taught and examined."""

    rlas_of: dict[str, int]
    """RLAs of each taught behaviour, where there are several."""
    drives: tuple[DriveRow, ...]
    """Exams, each with the teacher's own drive."""

    @property
    def passed(self) -> int:
        """Number of exams that were passed."""
        return sum(each.passed for each in self.drives)


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyJob(StoredJob):
    """Drives of one robot, which leave a file of results and one of knowledge."""

    gives_lesson: ClassVar[bool] = False
    """True if the job gives the task's own lesson to a robot without knowledge, as a batch can."""
    gives_exams: ClassVar[bool] = False
    """True if the job examines robots that were taught its task, as a batch can."""
    factory: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    engines: Engines = ON_BUS
    """Loops that drive, which change no result."""

    @abstractmethod
    async def measure(self, knowledge: Path, report: Report) -> Settings:
        """Train and examine the robot and return the outcome; `knowledge` is the file to teach into.

        Raises KnowledgeError, SettingsError, LessonLostError, BatchRefusedError, BatchDiffersError.
        """

    async def teach(
        self,
        knowledge: Path,
        report: Report,
        task: TaskSettings | None = None,
        plan: LessonPlan | None = None,
        learners: LearnerTeam | None = None,
    ) -> GivenLesson:
        """Teach the robot into the file `knowledge`; return the result with all events that the file then holds.

        `task`: None: the job's. `plan`: None: the task's own lesson, by the engine of lessons. `learners`: None: RLAs
        decide. Raises the errors of `curriculum.run_lesson`.
        """
        return await run_lesson(
            self.factory,
            self.robot,
            task or self.task,
            knowledge,
            seed=self.seed,
            report=report,
            plan=plan,
            engine=self.engines.lesson if plan is None else Engine.CAN,
            learners=learners,
        )

    def run(self, on_progress: Progress) -> None:
        """Run the job in an event loop of its own, and store result and knowledge; `on_progress` gets robot time in s.

        Raises the errors of `measure`, and OSError if the results cannot be stored.
        """
        before_s = now_s = 0.0

        def report(_what: str, done_s: float, _whole_s: float) -> None:
            nonlocal before_s, now_s
            if done_s < now_s:  # the next drive of the job
                before_s += now_s
            now_s = done_s
            on_progress(before_s + done_s)

        with self.results.scratch() as folder:
            outcome = anyio.run(self.measure, folder / "knowledge", report)
            if self.knowledge_name is not None:
                self.results.keep(folder / "knowledge", self.knowledge_name)
        self.results.write(self, outcome)


@dataclass(frozen=True, slots=True, kw_only=True)
class CurriculumJob(StudyJob):
    """Training run and exams of one robot."""

    outcome = ExaminedOutcome
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True
    keeps_places: ClassVar[bool] = False
    """True if the exams are stored with the places of pictures."""
    worlds: tuple[str, ...]
    """Worlds of the exams."""

    async def measure(self, knowledge: Path, report: Report) -> ExaminedOutcome:
        """Teach the robot into the file `knowledge`, examine it and return the outcome."""
        factory, robot, task, seed, engine = self.factory, self.robot, self.task, self.seed, self.engines.exams
        lesson, events = await self.teach(knowledge, report)
        exams = await run_exams(factory, robot, task, events, self.worlds, seed=seed, report=report, engine=engine)
        counts, several = Counter(rla.behaviour for rla in lesson.rlas), len(task.behaviours) > 1
        return ExaminedOutcome(
            made_of=self.made_of,
            seed=seed,
            lesson=lesson.counts,
            rlas_of={name: counts[name] for name in task.behaviours} if several else {},
            drives=tuple(each.stored(places=self.keeps_places) for each in exams),
        )


def curriculum_time_s(task: TaskSettings, worlds: int) -> float:
    """Return the time of the lesson, and in so many worlds of the exam and of the teacher's own drive, in s."""
    return task.teaching.duration_s + 2 * worlds * task.exam.duration_s


def world_of(place: str, seed: int) -> str:
    """Return the name of one robot's world, with its seed where `place` has SEED."""
    return place.replace(SEED, str(seed))


def require_places(factory: SimulationFactory, task: TaskSettings, worlds: Iterable[str]) -> None:
    """Check that all worlds can be built, and that the task can be driven there. Raises SettingsError."""
    needed = tuple(dict.fromkeys(worlds))
    factory.require_worlds(*needed)
    require_metric(factory, task, needed)
