"""Job of a study: drives of one robot in simulated time, with a stored result."""

from abc import ABC, abstractmethod
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
from kurt2rt.experiments.study.pool import Progress
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results
from simbridge.contracts.simulation import SimulationFactory


class JobParts(TypedDict):
    """Fields that all jobs of a study share."""

    factory: SimulationFactory
    robot: RobotSettings
    results: Results


class Outcome(Settings):
    """Result of a job as its study stores it in JSON, with what made it."""

    made_of: Provenance
    seed: int


class TaughtOutcome(Outcome):
    """Stored outcome of a robot that was taught."""

    lesson: LessonCounts


class ExaminedOutcome(TaughtOutcome):
    """Stored outcome of a robot that was taught and examined."""

    rlas_of: dict[str, int]
    """RLAs of each taught behaviour, where there are several."""
    drives: tuple[DriveRow, ...]
    """Exams, each with the teacher's own drive."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyJob(ABC):
    """Drives of one robot, in a process of their own, which leave a file of results and one of knowledge."""

    outcome: ClassVar[type[Settings]]
    """Schema of the result."""
    replaces_others: ClassVar[bool] = False
    keeps_knowledge: ClassVar[bool] = True
    gives_lesson: ClassVar[bool] = False
    """True if the job gives the task's own lesson to a robot without knowledge, as a batch can."""
    gives_exams: ClassVar[bool] = False
    """True if the job examines robots that were taught its task, as a batch can."""
    factory: SimulationFactory
    robot: RobotSettings
    results: Results
    task: TaskSettings
    seed: int
    made_of: Provenance
    name: str
    """Name in progress displays."""
    stem: str
    """Path of result and knowledge, without the top folder and the ending."""
    robot_time_s: float
    """Simulated time in s, at most."""
    engines: Engines = ON_BUS
    """Loops that drive, which change no result."""
    wave: int = 0
    """The job needs results of earlier waves only."""

    @abstractmethod
    async def measure(self, knowledge: Path, report: Report) -> Settings:
        """Train and examine the robot and return the outcome; `knowledge` is the file to teach into.

        Raises KnowledgeError, SettingsError, LessonLostError, BatchRefusedError, BatchDiffersError.
        """

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        return f"results/{self.stem}.json"

    @property
    def knowledge_name(self) -> str | None:
        """Path of the stored knowledge within the folder of results; None: the job stores none."""
        return f"knowledge/{self.stem}.knowledge" if self.keeps_knowledge else None

    @property
    def knowledge(self) -> Path:
        """Path of the stored knowledge file in the folder of results; it exists after the job."""
        assert self.knowledge_name is not None
        return self.results.folder / self.knowledge_name

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
        anyio.run(self._run, ProgressSum(on_progress).report)

    async def _run(self, report: Report) -> None:
        with self.results.scratch() as folder:
            outcome = await self.measure(folder / "knowledge", report)
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


class ProgressSum:
    """Sum of the robot time of successive drives."""

    def __init__(self, tell: Progress) -> None:
        self._tell = tell
        self._before_s = 0.0
        self._now_s = 0.0

    def report(self, what: str, done_s: float, whole_s: float) -> None:  # noqa: ARG002 - as curriculum.Report
        """Report the sum after `done_s`, in s, of a drive; a smaller `done_s` than before begins the next drive.

        `what` and `whole_s` are not used.
        """
        if done_s < self._now_s:
            self._before_s += self._now_s
        self._now_s = done_s
        self._tell(self._before_s + done_s)


SEED = "SEED"
"""Part of a world's name that stands for a robot's seed."""


def world_of(place: str, seed: int) -> str:
    """Return the name of one robot's world, with its seed where `place` has SEED."""
    return place.replace(SEED, str(seed))


def require_places(factory: SimulationFactory, task: TaskSettings, worlds: Iterable[str]) -> None:
    """Check that all worlds can be built, and that the task can be driven there. Raises SettingsError."""
    needed = tuple(dict.fromkeys(worlds))
    factory.require_worlds(*needed)
    require_metric(factory, task, needed)
