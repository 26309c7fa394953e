"""Plan of a certificate: blocks of runs and witnesses, and their outcomes."""

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from hal.batch import BatchFactory
from hal.batch_refusal import BatchRefusedError
from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.certify.drives import Subject, opened_batch
from kurt2rt.experiments.certify.jobs import BlockJob, WitnessJob, require_equal
from kurt2rt.experiments.certify.outcome import BlockOutcome, RunOutcome, WitnessOutcome
from kurt2rt.experiments.certify.run import ALL_WORK, SEED, BrokenShare, Run, draw_runs
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop, choose_witnesses
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Fingerprints, settings_hash
from kurt2rt.experiments.study.results import Results
from kurt2rt.knowledge.journal.loading import read_lessons

_MOST_RUNS = 200
_MOST_ROBOT_S = 60_000.0
"""Limits of a job in the batch, which keeps the set points of all its runs: 24 MB."""


class Extent(NamedTuple):
    """Number and worlds of the runs."""

    first: int
    """Number of the first run."""
    runs: int
    places: tuple[str, ...]
    """Worlds; SEED in a name stands for the number of the run."""
    loop: DriveLoop
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


@dataclass(frozen=True, slots=True)
class CertifyPlan:
    """Jobs of a certificate."""

    task: TaskSettings
    extent: Extent
    runs: tuple[Run, ...]
    witnesses: tuple[WitnessJob, ...]
    blocks: tuple[BlockJob, ...]

    @property
    def waves(self) -> tuple[tuple[WitnessJob | BlockJob, ...], ...]:
        """Witnesses first: where one differs, the blocks are not worth driving."""
        return self.witnesses, self.blocks


@dataclass(frozen=True, slots=True)
class Certificate:
    """Plan and outcomes."""

    plan: CertifyPlan
    outcomes: tuple[RunOutcome, ...]
    """One for each run of the plan, in order."""
    on_bus: frozenset[int]
    """Numbers of the runs that only the CAN loop drove."""
    compared: int
    """Runs that the batch and the CAN loop drove with equal outcomes."""


def make_plan(
    task: TaskSettings,
    knowledge: Path,
    extent: Extent,
    parts: JobParts,
) -> CertifyPlan:
    """Check knowledge, task and worlds, and return the jobs.

    Args:
        task: that the robot was taught.
        knowledge: file with its lessons.
        extent: number and worlds of the runs.
        parts: factory, robot and results of the jobs.

    Raises:
        KnowledgeError: the knowledge file cannot be read.
        hal.settings.SettingsError: the knowledge holds no lesson, or task and worlds do not fit.
    """
    factory, robot = parts["factory"], parts["robot"]
    lessons = read_lessons(knowledge, robot, task)
    if not lessons:
        raise SettingsError("holds no lesson", where=knowledge, do="teach the robot first")
    runs = draw_runs(extent.first, extent.runs, extent.places, extent.broken)
    needed = {place: place.replace(SEED, str(extent.first)) for place in dict.fromkeys(extent.places)}
    factory.require_worlds(*needed.values())
    require_course(factory, task, needed.values())
    fingerprints = Fingerprints(factory, robot)
    # A generated world follows from its name and the source: all of them need not be built here.
    worlds, taught = [world for place, world in needed.items() if SEED not in place], settings_hash(repr(lessons))

    def block(part: tuple[Run, ...]) -> BlockJob:
        made_of = fingerprints.of(task, worlds, taught, repr((part, extent.loop)))
        return BlockJob(task=task, knowledge=knowledge, runs=part, loop=extent.loop, made_of=made_of, **parts)

    def witness(run: Run) -> WitnessJob:
        made_of = fingerprints.of(task, worlds, taught, repr(run))
        return WitnessJob(task=task, knowledge=knowledge, witness=run, made_of=made_of, **parts)

    step, witnesses = 1, list[Run]()
    if extent.loop is DriveLoop.BATCH:
        step = min(_MOST_RUNS, max(1, int(_MOST_ROBOT_S / task.exam.duration_s)))
        working = [run for run in runs if not run.broken]  # the CAN loop alone drives the others
        witnesses = choose_witnesses(working, f"{len(runs)} runs from {extent.first}")
    blocks = (tuple(runs[begin : begin + step]) for begin in range(0, len(runs), step))
    return CertifyPlan(task, extent, tuple(runs), tuple(map(witness, witnesses)), tuple(map(block, blocks)))


def read_certificate(plan: CertifyPlan, results: Results) -> Certificate:
    """Read the results of all jobs of the plan.

    Raises:
        StudyError: a result is missing or damaged.
        BatchDiffersError: the outcome of a witness is another one than that of its block.
    """
    blocks = [results.read(job, BlockOutcome) for job in plan.blocks]
    witnesses = [results.read(job, WitnessOutcome) for job in plan.witnesses]
    outcomes = {each.number: each for block in blocks for each in block.runs}
    for each in witnesses:
        require_equal(outcomes[each.run.number], each.run)
    return Certificate(
        plan,
        tuple(outcomes.values()),
        frozenset(number for block in blocks for number in block.on_bus),
        sum(each.compared for each in witnesses),
    )
