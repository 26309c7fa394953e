"""Plan of a study: its jobs, the engines that drive them, and the robots with a witness on the CAN bus."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Generic, NamedTuple, Self, TypeVar

from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams, require_known_lesson
from kurt2rt.experiments.lockstep.engine import Engine, Engines, choose_witnesses
from kurt2rt.experiments.study.bus_witness import BusWitnessJob
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.study.results import OutcomeT, Results
from simbridge.contracts.batch import BatchRefusedError

JobT = TypeVar("JobT", bound=StudyJob)
KeyT = TypeVar("KeyT")
RowT = TypeVar("RowT")
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
class StudyPlan(Generic[AboutT]):
    """Jobs of a study, in the order of its tables."""

    about: AboutT
    """Facts that the tables tell next to the results."""
    seeds: tuple[int, ...]
    jobs: tuple[StudyJob, ...]
    """Jobs without witnesses."""
    witnesses: tuple[BusWitnessJob, ...] = ()
    refusals: tuple[str, ...] = ()
    """One line for each thing that the batch does not know, with the tasks."""

    @property
    def results(self) -> Results:
        """Folder of the results of all jobs."""
        return self.jobs[0].results

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """Jobs and their witnesses in waves; the jobs of a wave need only results of earlier waves."""
        jobs = (*self.jobs, *self.witnesses)
        return tuple(tuple(job for job in jobs if job.wave == wave) for wave in sorted({job.wave for job in jobs}))

    def of(self, kind: type[JobT]) -> tuple[JobT, ...]:
        """Return the jobs of a kind."""
        return tuple(job for job in self.jobs if isinstance(job, kind))

    def driven(self, asked: EngineRequest, robot: RobotSettings) -> Self:
        """Return the plan with jobs that this engine drives, and witnesses of 1 % of those in a batch, at least three.

        A task that the batch does not know is driven on the CAN bus. `AUTO` is a batch if that saves time. Raises
        config.settings.SettingsError if settings of a task do not fit each other.
        """
        if asked is EngineRequest.CAN:
            return self
        known, engines = _KnownTasks(robot), dict[str, Engines]()
        for job in self.jobs:
            lesson = job.gives_lesson and known.knows(job.task, "lessons", require_known_lesson)
            exams = job.gives_exams and known.knows(job.task, "exams", require_known_exams)
            if lesson or exams:
                engines[job.stem] = Engines(*(Engine.COMPILED if each else Engine.CAN for each in (lesson, exams)))
        taught = [stem for stem, own in engines.items() if own.lesson is Engine.COMPILED]
        examined = [stem for stem, own in engines.items() if own.exams is Engine.COMPILED]
        # By the same chance, so that one witness does for a robot with both.
        witnessed = {*choose_witnesses(taught, "robots"), *choose_witnesses(examined, "robots")}
        saved_s = sum(job.robot_time_s for job in self.jobs if job.stem in engines.keys() - witnessed)
        if asked is EngineRequest.AUTO and saved_s < WORTHWHILE_S:
            return self
        jobs = tuple(replace(job, engines=engines.get(job.stem, job.engines)) for job in self.jobs)
        witnesses = tuple(map(BusWitnessJob.witness_of, (job for job in jobs if job.stem in witnessed)))
        return replace(self, jobs=jobs, witnesses=witnesses, refusals=known.refusals)


class _KnownTasks:
    """Tasks that a batch knows, each looked at once."""

    def __init__(self, robot: RobotSettings) -> None:
        self._robot = robot
        self._refused: dict[tuple[int, str], str] = {}
        """Reasons for the CAN bus, empty if the batch knows all, by the id of the task and the kind of drive."""
        self._kinds: dict[tuple[str, str], dict[str, None]] = {}
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
                self._kinds.setdefault((task.name, error.what), {})[kind] = None
        return not self._refused[key]

    @property
    def refusals(self) -> tuple[str, ...]:
        tasks: dict[tuple[str, str], list[str]] = {}
        for (name, what), kinds in self._kinds.items():
            tasks.setdefault((" and ".join(kinds), what), []).append(name)
        return tuple(
            f"{', '.join(names)}: {kinds} on the CAN bus, because {what}" for (kinds, what), names in tasks.items()
        )


class Group(NamedTuple, Generic[KeyT, RowT]):
    """Rows that share a line of a table."""

    of: KeyT
    """Key that they have in common."""
    rows: tuple[RowT, ...]
    """Rows in the order of the seeds."""


def group_by(rows: Iterable[RowT], key: Callable[[RowT], KeyT]) -> tuple[Group[KeyT, RowT], ...]:
    """Return rows in groups of what `key` returns, which need not be hashable; groups in order of their first rows."""
    keys: list[KeyT] = []
    groups: list[list[RowT]] = []
    for row in rows:
        of = key(row)
        if of not in keys:
            keys.append(of)
            groups.append([])
        groups[keys.index(of)].append(row)
    return tuple(Group(of, tuple(group)) for of, group in zip(keys, groups, strict=True))


def read_groups(
    jobs: Iterable[JobT], key: Callable[[JobT], KeyT], schema: type[OutcomeT]
) -> tuple[Group[KeyT, OutcomeT], ...]:
    """Return the outcomes of jobs, grouped by what `key` returns; raises StudyError if one is missing or damaged."""
    return tuple(
        Group(group.of, tuple(job.results.read(job, schema) for job in group.rows)) for group in group_by(jobs, key)
    )
