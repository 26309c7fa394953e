"""Certificate: runs of one taught robot in blocks, and witnesses that batch and CAN bus drive."""

import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, NamedTuple

from config.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import (
    ON_BUS,
    BatchDiffersError,
    Engine,
    Engines,
    choose_witnesses,
)
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind, parse_break
from kurt2rt.experiments.study.bus_witness import BusWitnessJob
from kurt2rt.experiments.study.jobs import SEED, JobParts, StudyJob, require_places, world_of
from kurt2rt.experiments.study.provenance import Fingerprints, settings_hash
from kurt2rt.experiments.study.results import Outcome
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.journal.loading import read_lessons

BATCH_GAIN = 100.0
"""A run in the batch counts as so many times less robot time in the progress than one on the CAN bus."""
_MOST_RUNS = 200
_MOST_ROBOT_S = 60_000.0
"""Limits of a job in the batch, which keeps the set points of all its runs: 24 MB."""


class BrokenShare(NamedTuple):
    """Share of the runs with a broken sensor, and the sensors that may break."""

    share: float
    """0 to 1."""
    sensors: tuple[str, ...]
    """Names, such as s15."""


ALL_WORK = BrokenShare(0.0, ())


class Run(NamedTuple):
    """One drive without a teacher, repeated by `kurt2rt exam --seed NUMBER --world WORLD`."""

    number: int
    """Seed of the robot, its noise, its start and the choice of the world."""
    place: str
    """Kind of world, with SEED where each run has a world of its own."""
    broken: str = ""
    """Sensor that breaks and the way in which, such as s15=low; empty: all work."""

    @property
    def world(self) -> str:
        """Name of the world of this run, its number put in."""
        return world_of(self.place, self.number)


def draw_runs(first: int, count: int, places: Sequence[str], broken: BrokenShare = ALL_WORK) -> list[Run]:
    """Return the runs of the numbers from `first` on; each place is equally likely for each run."""
    return [
        Run(number, random.Random(f"world of run {number}").choice(places), _draw_break(number, broken))
        for number in range(first, first + count)
    ]


def _draw_break(number: int, broken: BrokenShare) -> str:
    chance = random.Random(f"broken sensor of run {number}")
    if chance.random() >= broken.share:
        return ""
    return f"{chance.choice(broken.sensors)}={chance.choice(list(FaultKind))}"


class BlockOutcome(Outcome):
    """Drives of the runs of one job, in order."""

    drives: tuple[DriveRow, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockJob(StudyJob):
    """Runs that one process drives, at once in a batch; the job's seed is the first of their numbers."""

    outcome = BlockOutcome
    keeps_knowledge: ClassVar[bool] = False
    taught: Path
    """File with the lessons of the robot."""
    runs: tuple[Run, ...]
    places: bool = False
    """True if the drives are stored with the places of pictures."""

    async def measure(self, knowledge: Path, report: Report) -> BlockOutcome:  # noqa: ARG002 - nothing is taught
        """Drive all runs and return the outcome."""
        events, infrared = read_lessons(self.taught, self.robot, self.task), self.robot.infrared
        setups = []
        for run in self.runs:
            broken = parse_break(run.broken, infrared) if run.broken else None
            setups.append(ExamSetup(run.world, run.number, events=events, broken=broken))
        engine = self.engines.exams
        drives = await run_drives(self.factory, self.robot, self.task, setups, report, engine, measured=False)
        stored = tuple(each.stored(places=self.places) for each in drives)
        return BlockOutcome(made_of=self.made_of, seed=self.seed, drives=stored)


class Extent(NamedTuple):
    """Number and worlds of the runs."""

    first: int
    """Number of the first run."""
    runs: int
    places: tuple[str, ...]
    """Worlds; SEED in a name stands for the number of the run."""
    engine: Engine
    broken: BrokenShare = ALL_WORK


class Certified(NamedTuple):
    """Task and knowledge that are certified, and the runs."""

    task: TaskSettings
    knowledge: Path
    extent: Extent
    runs: tuple[Run, ...]


def make_plan(task: TaskSettings, knowledge: Path, extent: Extent, parts: JobParts) -> StudyPlan[Certified]:
    """Check knowledge, task and worlds, and return the jobs; a witness that differs refuses all of them.

    Raises KnowledgeError, and config.settings.SettingsError if the knowledge holds no lesson, or task and worlds do not
    fit.
    """
    lessons = read_lessons(knowledge, parts["robot"], task)
    if not lessons:
        raise SettingsError("holds no lesson", where=knowledge, do="teach the robot first")
    runs = tuple(draw_runs(extent.first, extent.runs, extent.places, extent.broken))
    require_places(parts["factory"], task, [world_of(place, extent.first) for place in extent.places])
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    # A generated world follows from its name and the source: all of them need not be built here.
    worlds, taught = [place for place in extent.places if SEED not in place], settings_hash(repr(lessons))

    def block(part: Sequence[Run], engine: Engine, gain: float = 1.0) -> BlockJob:
        first, last = part[0].number, part[-1].number
        return BlockJob(
            **parts,
            task=task,
            seed=first,
            made_of=fingerprints.of(task, worlds, taught, repr(tuple(part))),
            name=f"run {first} in world {part[0].world}" if first == last else f"runs {first} to {last}",
            stem=f"runs-{first}-{last}",
            robot_time_s=task.exam.duration_s * len(part) / gain,
            engines=Engines(exams=engine),
            wave=1,
            taught=knowledge,
            runs=tuple(part),
        )

    in_batch = [run for run in runs if extent.engine is Engine.COMPILED and not run.broken]
    step = min(_MOST_RUNS, max(1, int(_MOST_ROBOT_S / task.exam.duration_s)))
    blocks = [block(in_batch[at : at + step], Engine.COMPILED, BATCH_GAIN) for at in range(0, len(in_batch), step)]
    alone = [block((run,), Engine.CAN) for run in runs if run.broken or extent.engine is Engine.CAN]
    chosen = choose_witnesses(in_batch, f"{len(runs)} runs from {extent.first}")
    witnesses = tuple(BusWitnessJob.witness_of(replace(block((run,), Engine.COMPILED), wave=0)) for run in chosen)
    numbers = tuple(run.number for run in runs)
    return StudyPlan(Certified(task, knowledge, extent, runs), numbers, (*blocks, *alone), witnesses)


def read_drives(plan: StudyPlan[Certified]) -> tuple[DriveRow, ...]:
    """Return the drive of each run in order. Raises StudyError if a result is missing or damaged."""
    outcomes = (job.results.read(job, BlockOutcome) for job in plan.of(BlockJob))
    drives = {each.seed: each for outcome in outcomes for each in outcome.drives}
    return tuple(drives[number] for number in plan.seeds)


def picture_jobs(plan: StudyPlan[Certified], runs: Iterable[DriveRow]) -> list[BlockJob]:
    """Return a job for each of these runs, which drives it again on the CAN bus, for the places of its picture."""
    by_number = {run.number: (job, run) for job in plan.of(BlockJob) for run in job.runs}
    jobs = []
    for each in runs:
        job, run = by_number[each.seed]
        name, stem = f"picture of run {each.seed}", f"pictures/run-{each.seed}"
        made = replace(job, seed=each.seed, name=name, stem=stem, robot_time_s=job.task.exam.duration_s)
        jobs.append(replace(made, engines=ON_BUS, runs=(run,), places=True))
    return jobs


def read_pictures(jobs: Iterable[BlockJob], runs: Iterable[DriveRow]) -> list[DriveRow]:
    """Return the drives of picture jobs, with their places.

    `runs`: as they were driven before. Raises BatchDiffersError where the outcome is another one, StudyError.
    """
    drives = []
    for job, before in zip(jobs, runs, strict=True):
        (again,) = job.results.read(job, BlockOutcome).drives
        if again.stored() != before:
            raise BatchDiffersError(
                "the batch and the CAN bus differ; all results of the batch are refused",
                where=f"run {before.seed} in world {before.world}",
                do="report it, and give --engine can and a new folder with --out",
            )
        drives.append(again)
    return drives
