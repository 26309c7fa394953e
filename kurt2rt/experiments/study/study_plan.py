"""Plan of a study: its jobs, the engines that drive them, and the robots with a witness on the CAN bus."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Generic, NamedTuple, Self, TypeVar

from config.settings import Settings
from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams, require_known_lesson
from kurt2rt.experiments.lockstep.engine import ON_BUS, Engine, Engines, choose_witnesses
from kurt2rt.experiments.study.bus_witness import BusWitnessJob
from kurt2rt.experiments.study.jobs import StudyJob
from simbridge.contracts.batch import BatchRefusedError

JobT = TypeVar("JobT", bound=StudyJob)
KeyT = TypeVar("KeyT")
OutcomeT = TypeVar("OutcomeT", bound=Settings)
AboutT = TypeVar("AboutT")

WORTHWHILE_S = 1800.0
"""Robot time that a batch has to save, in s: so long a drive on the CAN bus takes as long as compiling the batch."""


class EngineRequest(StrEnum):
    """Engine that a user asks for."""

    AUTO = "auto"
    """Compiled engine if it is installed, knows the task, and saves time."""
    COMPILED = "compiled"
    """Compiled engine if it knows the task."""
    CAN = "can"


@dataclass(frozen=True, slots=True)
class RequestedEngine:
    """Request for a study's lessons and exams."""

    engine: EngineRequest = EngineRequest.CAN
    compiled: bool = False
    """True if a compiled batch can drive the study's simulation."""


ALL_ON_BUS = RequestedEngine()


@dataclass(frozen=True, slots=True)
class EngineChoice:
    """Engines of all jobs of a study."""

    engines: Mapping[str, Engines]
    """Engines by the stem of the job; jobs that are not named are driven on the CAN bus."""
    witnessed: frozenset[str]
    """Stems of the jobs with a witness."""
    refusals: tuple[str, ...]
    """One line for each thing that the batch does not know, with the tasks."""

    def apply(self, jobs: Sequence[JobT]) -> tuple[JobT, ...]:
        """Return the jobs with their engines."""
        return tuple(replace(job, engines=self.engines.get(job.stem, ON_BUS)) for job in jobs)

    def witnesses(self, jobs: Sequence[StudyJob]) -> tuple[BusWitnessJob, ...]:
        """Return the witnesses of these jobs."""
        return tuple(map(BusWitnessJob.witness_of, (job for job in jobs if job.stem in self.witnessed)))


NO_CHOICE = EngineChoice({}, frozenset(), ())
"""All jobs are driven on the CAN bus."""


@dataclass(frozen=True, slots=True)
class StudyPlan(Generic[AboutT]):
    """Jobs of a study, in the order of its tables."""

    about: AboutT
    """Facts that the tables tell next to the results."""
    seeds: tuple[int, ...]
    jobs: tuple[StudyJob, ...]
    """Jobs without witnesses."""
    choice: EngineChoice = NO_CHOICE
    """Engines of the jobs."""

    def driven(self, asked: "RequestedEngine", robot: RobotSettings) -> Self:
        """Return the plan with jobs that this engine drives. Raises config.settings.SettingsError."""
        choice = choose_engines(self.jobs, asked, robot)
        return replace(self, jobs=choice.apply(self.jobs), choice=choice)

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """Jobs and their witnesses in waves; the jobs of a wave need only results of earlier waves."""
        jobs = (*self.jobs, *self.choice.witnesses(self.jobs))
        return tuple(tuple(job for job in jobs if job.wave == wave) for wave in sorted({job.wave for job in jobs}))

    def of(self, kind: type[JobT]) -> tuple[JobT, ...]:
        """Return the jobs of a kind."""
        return tuple(job for job in self.jobs if isinstance(job, kind))


class Group(NamedTuple, Generic[KeyT, OutcomeT]):
    """Robots that share a row of a table."""

    of: KeyT
    """Key that they have in common."""
    outcomes: tuple[OutcomeT, ...]
    """One per robot, in the order of the seeds."""


def read_groups(
    jobs: Iterable[JobT], key: Callable[[JobT], KeyT], schema: type[OutcomeT]
) -> tuple[Group[KeyT, OutcomeT], ...]:
    """Return the outcomes of jobs, grouped by what `key` returns; raises StudyError if one is missing or damaged."""
    groups: list[tuple[KeyT, list[OutcomeT]]] = []
    for job in jobs:
        of, outcome = key(job), job.results.read(job, schema)
        own = next((outcomes for other, outcomes in groups if other == of), None)
        if own is None:
            groups.append((of, [outcome]))
        else:
            own.append(outcome)
    return tuple(Group(of, tuple(outcomes)) for of, outcomes in groups)


def choose_engines(jobs: Sequence[StudyJob], asked: RequestedEngine, robot: RobotSettings) -> EngineChoice:
    """Return the engines of all jobs of a study, and 1 % of those with a batch, at least three, that have a witness.

    A task that the batch does not know is driven on the CAN bus.

    Args:
        jobs: of the whole study.
        asked: what the user asks for.
        robot: settings of the robot.

    Raises:
        config.settings.SettingsError: settings of a task do not fit each other.
    """
    choice = _choose(jobs, asked, robot, auto=asked.compiled)
    saved_s = sum(job.robot_time_s for job in jobs if job.stem in choice.engines.keys() - choice.witnessed)
    return choice if saved_s >= WORTHWHILE_S else _choose(jobs, asked, robot, auto=False)


def _choose(jobs: Sequence[StudyJob], asked: RequestedEngine, robot: RobotSettings, *, auto: bool) -> EngineChoice:
    """Return the choice; `auto`: whether `EngineRequest.AUTO` means a batch."""
    compiled = asked.engine is EngineRequest.COMPILED or (auto and asked.engine is EngineRequest.AUTO)
    known = _KnownTasks(robot)
    engines = {}
    for job in jobs:
        lesson = compiled and job.gives_lesson and known.knows(job.task, "lessons", require_known_lesson)
        exams = compiled and job.gives_exams and known.knows(job.task, "exams", require_known_exams)
        if lesson or exams:
            engines[job.stem] = Engines(*(Engine.COMPILED if each else Engine.CAN for each in (lesson, exams)))
    taught = [stem for stem, own in engines.items() if own.lesson is Engine.COMPILED]
    examined = [stem for stem, own in engines.items() if own.exams is Engine.COMPILED]
    # By the same chance, so that one witness does for a robot with both.
    witnessed = {*choose_witnesses(taught, "robots"), *choose_witnesses(examined, "robots")}
    return EngineChoice(engines, frozenset(witnessed), known.refusals)


class _KnownTasks:
    """Tasks that a batch knows, each looked at once."""

    def __init__(self, robot: RobotSettings) -> None:
        self._robot = robot
        self._refused: dict[tuple[int, str], str] = {}
        """Reasons for the CAN bus, empty if the batch knows all, by the id of the task and the kind of drive."""
        self._kinds: dict[tuple[str, str], list[str]] = {}
        """Kinds of drives on the CAN bus by the name of the task and what the batch does not know."""

    def knows(self, task: TaskSettings, kind: str, require: Callable[[RobotSettings, TaskSettings], None]) -> bool:
        """Return whether a batch knows a kind of drive of a task, which `require` checks."""
        key = id(task), kind
        if key not in self._refused:
            self._refused[key] = ""
            try:
                require(self._robot, task)
            except BatchRefusedError as error:
                self._refused[key] = error.what
                kinds = self._kinds.setdefault((task.name, error.what), [])
                kinds += [kind] if kind not in kinds else []
        return not self._refused[key]

    @property
    def refusals(self) -> tuple[str, ...]:
        """One line for each thing that the batch does not know, with the tasks."""
        tasks: dict[tuple[str, str], list[str]] = {}
        for (name, what), kinds in self._kinds.items():
            tasks.setdefault((" and ".join(kinds), what), []).append(name)
        return tuple(
            f"{', '.join(names)}: {kinds} on the CAN bus, because {what}" for (kinds, what), names in tasks.items()
        )
