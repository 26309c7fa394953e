"""Certificate: blocks of runs in a batch, witnesses that the CAN bus drives as well, and the outcomes of all runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

import anyio

from hal.batch import BatchFactory, BatchRefusedError
from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.certify.drives import Subject, drive_in_batch, drive_on_bus, opened_batch
from kurt2rt.experiments.certify.run import ALL_WORK, BrokenShare, Run, RunOutcome, draw_runs
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.engine import BatchDiffersError, Engine, choose_witnesses
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.study.jobs import SEED, JobParts, Outcome, StudyJob, require_places, world_of
from kurt2rt.experiments.study.pool import PoolProgress, Progress, run_jobs
from kurt2rt.experiments.study.provenance import Fingerprints, settings_hash
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.journal.loading import read_lessons

BATCH_GAIN = 100.0
"""A run in the batch counts as so many times less robot time in the progress than one on the CAN bus."""
_MOST_RUNS = 200
_MOST_ROBOT_S = 60_000.0
"""Limits of a job in the batch, which keeps the set points of all its runs: 24 MB."""


class BlockOutcome(Outcome):
    """Outcomes of the runs of one job, in order."""

    runs: tuple[RunOutcome, ...]
    on_bus: tuple[int, ...] = ()
    """Numbers of the runs that the CAN bus drove alone, such as those with a broken sensor."""


class WitnessOutcome(Outcome):
    """Run that the batch and the CAN bus drove, with equal results."""

    run: RunOutcome
    compared: bool
    """False if the run left the batch, so that there was nothing to compare."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveJob(StudyJob):
    """Runs of one knowledge file, which the first of their numbers is the seed of."""

    keeps_knowledge: ClassVar[bool] = False
    taught: Path
    """File with the lessons of the robot."""

    def subject(self) -> Subject:
        """Return the taught robot. Raises KnowledgeError."""
        return Subject(self.robot, self.task, read_lessons(self.taught, self.robot, self.task))

    def drive_in_batch(self, subject: Subject, runs: Sequence[Run], tell: Progress) -> list[RunOutcome | None]:
        """Drive runs in a batch; `tell` gets their progress in s.

        Raises BatchRefusedError, and all that `drives.drive_in_batch` raises.
        """
        if not isinstance(self.factory, BatchFactory):
            raise BatchRefusedError("this simulation has no batch", do="give --engine can")
        return drive_in_batch(self.factory, subject, runs, lambda done_s: tell(done_s / BATCH_GAIN))


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockJob(DriveJob):
    """Runs that one process drives at once."""

    outcome = BlockOutcome
    runs: tuple[Run, ...]
    engine: Engine

    async def measure(self, knowledge: Path, report: Report) -> BlockOutcome:  # noqa: ARG002 - nothing is taught
        """Drive all runs and return their outcomes; those that leave the batch are driven on the CAN bus."""

        def tell(done_s: float) -> None:
            report(self.name, done_s, self.robot_time_s)

        subject = self.subject()
        working = [run for run in self.runs if not run.broken]
        in_batch = self.drive_in_batch(subject, working, tell) if working and self.engine is Engine.COMPILED else []
        finished = {each.number: each for each in in_batch if each}
        left = [run for run in self.runs if run.number not in finished]
        for run in left:
            finished[run.number], _ = await drive_on_bus(self.factory, subject, run, tell)
        return BlockOutcome(
            made_of=self.made_of,
            seed=self.seed,
            runs=tuple(finished[run.number] for run in self.runs),
            on_bus=tuple(run.number for run in left),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class WitnessJob(DriveJob):
    """Run that is driven in a batch and on the CAN bus, which must agree."""

    outcome = WitnessOutcome
    witness: Run

    async def measure(self, knowledge: Path, report: Report) -> WitnessOutcome:  # noqa: ARG002 - nothing is taught
        """Drive the run twice, compare, and return the outcome. Raises BatchDiffersError where the outcomes differ."""

        def tell(done_s: float) -> None:
            report(self.name, done_s, self.robot_time_s)

        subject = self.subject()
        (in_batch,) = self.drive_in_batch(subject, [self.witness], lambda _: None)
        on_bus, _ = await drive_on_bus(self.factory, subject, self.witness, tell)
        if in_batch is not None:
            require_equal(in_batch, on_bus)
        return WitnessOutcome(made_of=self.made_of, seed=self.seed, run=on_bus, compared=in_batch is not None)


def require_equal(batch: RunOutcome, bus: RunOutcome) -> None:
    """Check that a run in the batch had the outcome of the CAN bus. Raises BatchDiffersError."""
    if differing := batch.differing(bus):
        raise BatchDiffersError(
            f"the batch and the CAN bus differ in {', '.join(differing)}; all results of the batch are refused",
            where=f"run {bus.number} in world {bus.world}",
            do="report it, and give --engine can and a new folder with --out",
        )


class Extent(NamedTuple):
    """Number and worlds of the runs."""

    first: int
    """Number of the first run."""
    runs: int
    places: tuple[str, ...]
    """Worlds; SEED in a name stands for the number of the run."""
    engine: Engine
    broken: BrokenShare = ALL_WORK


def find_refusal(task: TaskSettings, knowledge: Path, run: Run, parts: JobParts) -> str:
    """Return why a batch cannot drive a robot with this knowledge in a run; empty if it can.

    Raises:
        KnowledgeError: the knowledge file cannot be read.
        hal.settings.SettingsError: task and world do not fit.
    """
    factory, robot = parts["factory"], parts["robot"]
    if not isinstance(factory, BatchFactory):
        return "this simulation has no batch"
    subject = Subject(robot, task, read_lessons(knowledge, robot, task))
    try:
        with opened_batch(factory, subject, [run]):
            return ""
    except BatchRefusedError as error:
        return str(error)


class Certified(NamedTuple):
    """Task that is certified, and its runs."""

    task: TaskSettings
    extent: Extent
    runs: tuple[Run, ...]


@dataclass(frozen=True, slots=True)
class Certificate:
    """Plan and outcomes."""

    plan: StudyPlan[Certified]
    outcomes: tuple[RunOutcome, ...]
    """One for each run of the plan, in order."""
    on_bus: frozenset[int]
    """Numbers of the runs that only the CAN bus drove."""
    compared: int
    """Runs that the batch and the CAN bus drove with equal outcomes."""


def make_plan(task: TaskSettings, knowledge: Path, extent: Extent, parts: JobParts) -> StudyPlan[Certified]:
    """Check knowledge, task and worlds, and return the jobs, the witnesses first: if one differs, all are refused.

    Args:
        task: that the robot was taught.
        knowledge: file with its lessons.
        extent: number and worlds of the runs.
        parts: factory, robot and results of the jobs.

    Raises:
        KnowledgeError: the knowledge file cannot be read.
        hal.settings.SettingsError: the knowledge holds no lesson, or task and worlds do not fit.
    """
    lessons = read_lessons(knowledge, parts["robot"], task)
    if not lessons:
        raise SettingsError("holds no lesson", where=knowledge, do="teach the robot first")
    runs = tuple(draw_runs(extent.first, extent.runs, extent.places, extent.broken))
    require_places(parts["factory"], task, [world_of(place, extent.first) for place in extent.places])
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    # A generated world follows from its name and the source: all of them need not be built here.
    worlds, taught = [place for place in extent.places if SEED not in place], settings_hash(repr(lessons))

    def block(part: tuple[Run, ...]) -> BlockJob:
        first, last, in_batch = part[0].number, part[-1].number, 0
        if extent.engine is Engine.COMPILED:
            in_batch = sum(not run.broken for run in part)
        return BlockJob(
            **parts,
            task=task,
            seed=first,
            made_of=fingerprints.of(task, worlds, taught, repr((part, extent.engine))),
            name=f"runs {first} to {last}",
            stem=f"runs-{first}-{last}",
            robot_time_s=task.exam.duration_s * (len(part) - in_batch + in_batch / BATCH_GAIN),
            wave=1,
            taught=knowledge,
            runs=part,
            engine=extent.engine,
        )

    def witness(run: Run) -> WitnessJob:
        return WitnessJob(
            **parts,
            task=task,
            seed=run.number,
            made_of=fingerprints.of(task, worlds, taught, repr(run)),
            name=f"run {run.number} on the CAN bus",
            stem=f"witness-{run.number}",
            robot_time_s=task.exam.duration_s,
            taught=knowledge,
            witness=run,
        )

    step, witnesses = 1, list[Run]()
    if extent.engine is Engine.COMPILED:
        step = min(_MOST_RUNS, max(1, int(_MOST_ROBOT_S / task.exam.duration_s)))
        working = [run for run in runs if not run.broken]  # the CAN bus alone drives the others
        witnesses = choose_witnesses(working, f"{len(runs)} runs from {extent.first}")
    blocks = (runs[begin : begin + step] for begin in range(0, len(runs), step))
    jobs = (*map(witness, witnesses), *map(block, blocks))
    return StudyPlan(Certified(task, extent, runs), tuple(run.number for run in runs), jobs)


def read_certificate(plan: StudyPlan[Certified]) -> Certificate:
    """Read the results of all jobs of the plan.

    Raises:
        StudyError: a result is missing or damaged.
        BatchDiffersError: the outcome of a witness is another one than that of its block.
    """
    blocks = [job.results.read(job, BlockOutcome) for job in plan.of(BlockJob)]
    witnesses = [job.results.read(job, WitnessOutcome) for job in plan.of(WitnessJob)]
    outcomes = {each.number: each for block in blocks for each in block.runs}
    for each in witnesses:
        require_equal(outcomes[each.run.number], each.run)
    return Certificate(
        plan,
        tuple(outcomes.values()),
        frozenset(number for block in blocks for number in block.on_bus),
        sum(each.compared for each in witnesses),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureJob:
    """Run of a block that the CAN bus drives again for its trail."""

    block: BlockJob
    expected: RunOutcome
    """Outcome of the same run before."""
    again: Run

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"picture of run {self.again.number}"

    @property
    def robot_time_s(self) -> float:
        """Simulated time in s."""
        return self.block.task.exam.duration_s

    def run(self, tell: Progress) -> ExamResult:
        """Drive and return the result; `tell` gets the progress in s.

        Raises BatchDiffersError where the outcome is another one than before; else as `drives.drive_on_bus`.
        """
        block = self.block
        outcome, exam = anyio.run(drive_on_bus, block.factory, block.subject(), self.again, tell)
        require_equal(self.expected, outcome)
        return exam


def drive_again(
    plan: StudyPlan[Certified],
    runs: Sequence[RunOutcome],
    processes: int,
    on_progress: Callable[[PoolProgress], None],
) -> list[ExamResult]:
    """Drive runs of the plan on the CAN bus and return their results, with trails, in order.

    Args:
        plan: of the certificate.
        runs: outcomes of the runs.
        processes: number of processes.
        on_progress: called with the progress of all runs.

    Raises:
        BatchDiffersError: the outcome of a run is another one than before.
        JobKilledError: a process was killed.
    """
    by_number = {run.number: (block, run) for block in plan.of(BlockJob) for run in block.runs}
    found = [(each, *by_number[each.number]) for each in runs]
    jobs = [PictureJob(block=block, expected=each, again=run) for each, block, run in found]
    return run_jobs(jobs, processes, on_progress=on_progress)
