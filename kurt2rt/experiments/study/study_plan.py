"""Plan of a study: its jobs, the engines that drive them, and witnesses of jobs in the batch on the CAN bus."""

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, ClassVar, Generic, NamedTuple, Self, TypeVar

from pydantic import ValidationError

from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams, require_known_lesson
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.engine import ON_BUS, BatchDiffersError, Engine, Engines, choose_witnesses
from kurt2rt.experiments.study.jobs import Outcome, OutcomeT, Progress, Results, StudyError, StudyJob
from kurt2rt.knowledge.journal.loading import read_knowledge
from simbridge.contracts.batch import BatchRefusedError

_MOST_NAMED = 5
_WITNESSES = "witnesses"
"""Folder, within that of the results, of comparisons of the batch with the CAN bus."""


class BusWitnessOutcome(Outcome):
    """Witness: the comparison of one robot that the batch drove with the same robot on the CAN bus.

    One differing part refuses all results of the folder.
    """

    job: str
    """Name of the job that was compared."""
    differing: tuple[str, ...]
    """Parts of result and knowledge that differ, at most 5; none if both are equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BusWitnessJob(StudyJob):
    """Job that repeats another job in the batch and on the CAN bus, and compares both results."""

    outcome = BusWitnessOutcome
    keeps_knowledge: ClassVar[bool] = False
    replaces_others: ClassVar[bool] = True
    of: StudyJob
    """Job that a compiled engine drives."""

    @classmethod
    def witness_of(cls, job: StudyJob) -> Self:
        """Return the witness of a job. It takes the longest of all jobs, and so a difference shows early."""
        return cls(
            factory=job.factory,
            robot=job.robot,
            results=job.results,
            task=job.task,
            seed=job.seed,
            made_of=job.made_of,
            name=f"{job.name}, witness on the CAN bus",
            stem=f"{_WITNESSES}/{job.stem}",
            robot_time_s=2 * job.robot_time_s,
            wave=job.wave,
            of=job,
        )

    async def measure(self, knowledge: Path, report: Report) -> BusWitnessOutcome:
        """Do the job twice and return the comparison; files next to `knowledge` are taught into.

        Raises the errors of the job.
        """
        batch, bus = (knowledge.with_name(name) for name in ("batch", "bus"))
        outcomes = [await self.of.measure(batch, report), await replace(self.of, engines=ON_BUS).measure(bus, report)]
        differing = list(_differing_parts("", *(json.loads(each.model_dump_json()) for each in outcomes)))
        taught = [read_knowledge(file, self.robot, self.task) if file.exists() else None for file in (batch, bus)]
        if taught[0] != taught[1]:
            differing.append("lessons or statistics in the knowledge file")
        return BusWitnessOutcome(
            made_of=self.made_of, seed=self.seed, job=self.of.name, differing=tuple(differing[:_MOST_NAMED])
        )

    def run(self, on_progress: Progress) -> None:
        """Run the job and store the comparison; `on_progress` gets robot time in s.

        Raises BatchDiffersError if batch and CAN bus differ, the errors of `measure`, and OSError.
        """
        super(BusWitnessJob, self).run(on_progress)
        _require_equal(self.results.read(self, BusWitnessOutcome))


def require_no_difference(results: Results, sources: Iterable[str]) -> None:
    """Refuse a folder of results in which a witness found that the batch differs from the CAN bus.

    `sources`: hashes of the program's source whose results are wanted. Raises BatchDiffersError, StudyError.
    """
    wanted = set(sources)
    for path in sorted((results.folder / "results" / _WITNESSES).rglob("*.json")):
        try:
            outcome = BusWitnessOutcome.model_validate_json(path.read_bytes())
        except ValidationError as error:
            raise StudyError("is not a witness of this program", where=path, do="delete it, and run again") from error
        if outcome.made_of.source in wanted:
            _require_equal(outcome)


def _require_equal(outcome: BusWitnessOutcome) -> None:
    if outcome.differing:
        raise BatchDiffersError(
            f"the batch and the CAN bus differ in {', '.join(outcome.differing)}; all results of the batch are refused",
            where=outcome.job,
            do="report it, and give --engine can, and a new folder with --out",
        )


def _differing_parts(name: str, batch: Any, bus: Any) -> Iterator[str]:
    """Yield the names of the parts that differ, such as `drives.0.progress`."""
    match batch, bus:
        case dict(), dict():
            pairs = [(key, batch.get(key), bus.get(key)) for key in batch | bus]
        case list(), list() if len(batch) == len(bus):
            pairs = [(str(place), *each) for place, each in enumerate(zip(batch, bus, strict=True))]
        case _:
            if batch != bus:
                yield name
            return
    for key, one, other in pairs:
        yield from _differing_parts(f"{name}.{key}" if name else key, one, other)


JobT = TypeVar("JobT", bound=StudyJob)
KeyT = TypeVar("KeyT")
RowT = TypeVar("RowT")
AboutT = TypeVar("AboutT")

WORTHWHILE_S = 1800.0
"""Robot time that a batch has to save, in s: so long a drive on the CAN bus takes as long as compiling the batch."""


class EngineRequest(StrEnum):
    """Engine that a user asks for with --engine; the plan chooses the engine by it."""

    AUTO = "auto"
    """Compiled engine if it is installed, knows the task, and saves time."""
    COMPILED = "compiled"
    """Compiled engine if it knows the task."""
    CAN = "can"


@dataclass(frozen=True, slots=True)
class StudyPlan(Generic[AboutT]):
    """Plan of a study: its jobs in the order of its tables, and the witnesses of what a batch drives."""

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
        """Return the plan with jobs that this engine drives, and witnesses of 1 % of those in a batch, three to twenty.

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
    """Rows of a table that share a key, such as the robots of one task."""

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
