"""Benchmark of exams and of a certificate's runs in a batch, with the same exams on the CAN bus as reference."""

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

from hal.batch import BatchFactory
from kurt2rt.checks.bench.closed_loop import on_one_core
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.certify.drives import Subject, drive_in_batch
from kurt2rt.experiments.certify.run import Run
from kurt2rt.experiments.lockstep.batch_exam import BatchExam, examine_in_batch
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup, examine
from kurt2rt.platform.ledger import percentiles_of

TIMES_THE_BUS = 20.0
RUNS_TIMES_THE_BUS = 60.0


@dataclass(frozen=True, slots=True)
class BatchLengths:
    """Amount of measurement of the batch."""

    robots: int
    """Robots in a batch: half of them with the fixture's knowledge, half by the policy."""
    exam_s: float
    batches: int
    on_bus: int
    """Exams of the batch that the bus drives as well."""


async def measure_batch(
    fixture: BenchFixture, lengths: BatchLengths, on_progress: OnProgress
) -> tuple[BenchResult, BenchResult]:
    """Return the time of a robot's tick in exams, with all their measures, and in runs of a certificate, on one core.

    Raises BatchRefusedError without a batch, and for a task that it does not know.
    """
    factory = fixture.batches
    assert factory is not None, "the fixture names no batch"
    task = _examined_for(fixture.task, lengths.exam_s)
    worlds = task.exam.worlds
    exams = [
        BatchExam(ExamSetup(worlds[i % len(worlds)], i, teacher_policy=i % 2 == 1), fixture.events)
        for i in range(lengths.robots)
    ]
    runs = [Run(i, worlds[i % len(worlds)]) for i in range(lengths.robots)]
    taught = Subject(fixture.settings, task, fixture.events)
    steps = lengths.batches + lengths.on_bus + 1
    with on_one_core() as core:
        finished = examine_in_batch(factory, fixture.settings, task, exams)  # compiles, or loads what is compiled
        on_progress(1 / steps)
        tick_ns, run_ns = [], []
        for done in range(lengths.batches):
            tick_ns.append(_time_batch(fixture, factory, task, exams))
            run_ns.append(_time_runs(factory, taught, runs))
            on_progress((2 + done) / steps)
        bus_ns, driven = [], []
        for done, exam in enumerate(exams[: lengths.on_bus]):
            begun_ns = time.perf_counter_ns()
            driven.append(await _drive_on_bus(fixture, factory, task, exam))
            bus_ns.append((time.perf_counter_ns() - begun_ns) * fixture.settings.cycle_s / driven[-1].duration_s)
            on_progress((2 + lengths.batches + done) / steps)
    compared = [(one, other) for one, other in zip(finished, driven, strict=False) if one is not None]
    equal = sum(one == other for one, other in compared)
    tick = percentiles_of([round(each) for each in tick_ns])
    run = percentiles_of([round(each) for each in run_ns])
    on_bus_us = percentiles_of([round(each) for each in bus_ns]).median_us
    reference = Reference("on the bus", on_bus_us, tick.median_us)
    run_reference = Reference("on the bus", on_bus_us, run.median_us)
    exams_result = BenchResult(
        "batch",
        "exam in a batch, a tick",
        tick,
        reference,
        (
            BenchGoal("ratio", reference.ratio, TIMES_THE_BUS, at_least=True),
            BenchGoal("equal", equal, len(compared), at_least=True),
        ),
        f"{lengths.batches} batches of {lengths.robots} robots for {lengths.exam_s:g} s on core {core}: "
        f"{1e6 / tick.median_us:,.0f} robot ticks a second; {equal} of {len(compared)} exams equal to the bus, "
        f"{sum(each is None for each in finished)} left the batch",
    )
    runs_result = BenchResult(
        "batch",
        "run of certify in a batch, a tick",
        run,
        run_reference,
        (BenchGoal("ratio", run_reference.ratio, RUNS_TIMES_THE_BUS, at_least=True),),
        f"{lengths.batches} batches of {lengths.robots} runs of {lengths.exam_s:g} s: "
        f"{1e6 / run.median_us:,.0f} robot ticks a second on core {core}, opening included",
    )
    return exams_result, runs_result


def _examined_for(task: TaskSettings, exam_s: float) -> TaskSettings:
    return task.model_copy(update={"exam": task.exam.model_copy(update={"duration_s": exam_s})})


def _time_batch(fixture: BenchFixture, factory: BatchFactory, task: TaskSettings, exams: Sequence[BatchExam]) -> float:
    """Return the time of a robot's tick in ns."""
    begun_ns = time.perf_counter_ns()
    results = examine_in_batch(factory, fixture.settings, task, exams)
    took_ns = time.perf_counter_ns() - begun_ns
    ticks = sum(each.duration_s for each in results if each is not None) / fixture.settings.cycle_s
    return took_ns / ticks


def _time_runs(factory: BatchFactory, taught: Subject, runs: Sequence[Run]) -> float:
    """Return the time of a robot's tick in ns, in runs that are counted and not measured."""
    begun_ns = time.perf_counter_ns()
    outcomes = drive_in_batch(factory, taught, runs, lambda _: None)
    took_ns = time.perf_counter_ns() - begun_ns
    return took_ns / sum(each.ticks for each in outcomes if each is not None)


async def _drive_on_bus(
    fixture: BenchFixture, factory: BatchFactory, task: TaskSettings, exam: BatchExam
) -> ExamResult:
    setup = exam.setup
    with closing(factory.open(setup.world, setup.seed, "exam")) as simulation:
        return await examine(simulation, fixture.settings, task, exam.events, setup, lambda _: None)
