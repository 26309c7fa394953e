"""Jobs of a study: drives of one robot in simulated time, and the folder that keeps a result of each."""

import fcntl
import shutil
import tempfile
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypedDict, TypeVar

import anyio
from pydantic import ValidationError

from config.errors import UserError
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
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.platform.durable_files import write_durably
from simbridge.contracts.simulation import SimulationFactory

_UNFINISHED = "unfinished-"
_NEW_FOLDER = "give a new folder with --out, or delete the results in this one"

Progress = Callable[[float], None]
"""Takes the simulated seconds of a job so far."""
OutcomeT = TypeVar("OutcomeT", bound=Settings)


class StudyError(UserError):
    """Stored results cannot be used, or experiments do not fit together."""


class Outcome(Settings):
    """Base of stored outcomes: result of a job as its study keeps it in JSON, with its provenance."""

    made_of: Provenance
    seed: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredJob(ABC):
    """Base of jobs that a pool runs, here or on other machines; each leaves its result in a file."""

    outcome: ClassVar[type[Settings]]
    """Schema of the result."""
    replaces_others: ClassVar[bool] = False
    """True if the job runs again, and replaces its result, if that is of other settings; False: it is refused."""
    keeps_knowledge: ClassVar[bool] = True
    results: "Results"
    seed: int
    """Seed of the robot; jobs of other robots need none of its files."""
    made_of: Provenance
    name: str
    """Name in progress displays."""
    stem: str
    """Path of result and knowledge, without the top folder and the ending."""
    robot_time_s: float
    """Simulated time in s, at most."""
    wave: int = 0
    """The job needs results of earlier waves only."""

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
        """Path of the stored knowledge file; it exists after the job."""
        assert self.knowledge_name is not None
        return self.results.folder / self.knowledge_name

    @abstractmethod
    def run(self, on_progress: Progress) -> None:
        """Run the job, and store result and knowledge; any error of the job is raised."""


class _AnyOutcome(Settings, extra="ignore"):
    made_of: Provenance


class Results:
    """Folder of a study's results, one file for each job; it can be sent to another process."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @contextmanager
    def held(self) -> Iterator[None]:
        """Make the folder, lock it against other runs, and remove unfinished jobs of an interrupted run.

        Raises StudyError while another run writes there, OSError where nothing can be written.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        with (self.folder / ".lock").open("ab") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                do = "wait for its end, or give another folder with --out"
                raise StudyError("another run writes here", where=self.folder, do=do) from error
            for left_over in self.folder.glob(f"{_UNFINISHED}*"):
                shutil.rmtree(left_over)
            yield

    @contextmanager
    def scratch(self) -> Iterator[Path]:
        """Yield a temporary folder for an unfinished job, deleted at the end of the context. Raises OSError."""
        with tempfile.TemporaryDirectory(prefix=_UNFINISHED, dir=self.folder) as folder:
            yield Path(folder)

    def missing(self, jobs: Sequence[StoredJob]) -> list[int]:
        """Return the indexes of the jobs that have no result yet.

        Raises StudyError if there are results of other settings, source or versions, or damaged files: they are never
        mixed.
        """
        foreign: list[str] = []
        differences: set[str] = set()
        missing = []
        for place, job in enumerate(jobs):
            path = self.folder / job.file
            if not path.exists():
                missing.append(place)
                continue
            other = self._read(path, _AnyOutcome).made_of.differences(job.made_of)
            if other and job.replaces_others:
                missing.append(place)
            elif other:
                foreign.append(job.file)
                differences.update(other)
            else:
                self.read(job, job.outcome)
        if foreign:
            what = ", ".join(name for name in Provenance.model_fields if name in differences)
            more = f" and {len(foreign) - 1} more" if len(foreign) > 1 else ""
            raise StudyError(
                f"{foreign[0]}{more} were made with other settings or another program (what differs: {what})",
                where=self.folder,
                do=_NEW_FOLDER,
            )
        return missing

    def write(self, job: StoredJob, outcome: Settings) -> None:
        """Store the outcome of a job, whole and durable. Raises OSError."""
        write_durably(self.folder / job.file, outcome.model_dump_json() + "\n")

    def read(self, job: StoredJob, schema: type[OutcomeT]) -> OutcomeT:
        """Return the outcome of a job. Raises StudyError if it is missing, damaged or of another schema."""
        return self._read(self.folder / job.file, schema)

    def keep(self, file: Path, name: str) -> None:
        """Move a finished file out of the scratch folder to `name`, a path within this folder. Raises OSError."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        file.replace(path)

    @staticmethod
    def _read(path: Path, schema: type[OutcomeT]) -> OutcomeT:
        try:
            return schema.model_validate_json(path.read_bytes())
        except (ValidationError, OSError) as error:
            raise StudyError("is not a result of this program", where=path, do=_NEW_FOLDER) from error


SEED = "SEED"
"""Part of a world's name that stands for a robot's seed."""


class JobParts(TypedDict):
    """Fields that all jobs of a study share: the simulator, the robot, and the folder of results."""

    factory: SimulationFactory
    robot: RobotSettings
    results: Results


class TaughtOutcome(Outcome):
    """Stored outcome of a job that taught a robot: the counts of its lesson."""

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
    """Base of the jobs of studies: drives of one robot, which leave a result and maybe a knowledge file."""

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
    """Job that teaches one robot its task, and examines it in each world."""

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


def shortened_task(task: TaskSettings, most_teaching_s: float | None, most_exam_s: float | None) -> TaskSettings:
    """Return the task with less time; both phases of training are shortened in proportion. None: no limit."""
    teaching, exam = task.teaching, task.exam
    if most_teaching_s is not None and teaching.duration_s > most_teaching_s:
        share, phases = most_teaching_s / teaching.duration_s, ("supervised_s", "corrections_s")
        teaching = teaching.model_copy(update={name: float(round(getattr(teaching, name) * share)) for name in phases})
    if most_exam_s is not None and exam.duration_s > most_exam_s:
        exam = exam.model_copy(update={"duration_s": most_exam_s})
    return task.model_copy(update={"teaching": teaching, "exam": exam})


def world_of(place: str, seed: int) -> str:
    """Return the name of one robot's world, with its seed where `place` has SEED."""
    return place.replace(SEED, str(seed))


def require_places(factory: SimulationFactory, task: TaskSettings, worlds: Iterable[str]) -> None:
    """Check that all worlds can be built, and that the task can be driven there. Raises SettingsError."""
    needed = tuple(dict.fromkeys(worlds))
    factory.require_worlds(*needed)
    require_metric(factory, task, needed)
