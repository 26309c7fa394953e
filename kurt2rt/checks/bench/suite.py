"""Benchmarks in order, in one run."""

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from kurt2rt.checks.bench.batch import BatchLengths, measure_batch
from kurt2rt.checks.bench.batch_lesson import BatchLessonLengths, measure_batch_lessons
from kurt2rt.checks.bench.channel import ChannelLengths, measure_channel
from kurt2rt.checks.bench.channel_load import LoadShifts
from kurt2rt.checks.bench.closed_loop import measure_closed_loop
from kurt2rt.checks.bench.lesson import measure_lessons
from kurt2rt.checks.bench.match import SIZES, Size, measure_match
from kurt2rt.checks.bench.program import ProgramTurns, measure_program
from kurt2rt.checks.bench.real_time import RealTimeTurns, run_in_real_time
from kurt2rt.checks.bench.recording import measure_recording
from kurt2rt.checks.bench.result import BenchResult
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress, learn
from kurt2rt.checks.bench.tick_budget import lateness_result, tick_results


class BenchName(StrEnum):
    """Name of a benchmark."""

    LATENESS = "lateness"
    TICK = "tick"
    PROGRAM = "program"
    MATCH = "match"
    LOOP = "loop"
    LESSON = "lesson"
    CHANNEL = "channel"
    RECORDING = "recording"
    BATCH = "batch"


@dataclass(frozen=True, slots=True)
class Lengths:
    """Amount of measurement of each benchmark."""

    learning_s: float
    """Simulated duration of the preceding lesson."""
    turns: RealTimeTurns
    program: ProgramTurns
    sizes: tuple[Size, ...]
    loop_blocks: int
    loop_block_s: int
    """Simulated seconds per block."""
    lessons: int
    channel: ChannelLengths
    recording: LoadShifts
    batch: BatchLengths
    batch_lessons: BatchLessonLengths


FULL = Lengths(
    learning_s=345.0,  # as long as the paper took: some 90 RLAs
    turns=RealTimeTurns(rounds=12, ticks=500, reference_ticks=250),
    program=ProgramTurns(rounds=6, ticks=500, empty_ticks=200),
    sizes=SIZES,
    loop_blocks=15,
    loop_block_s=20,
    lessons=200,
    channel=ChannelLengths(presses=200, shifts=LoadShifts(rounds=8, ticks=250), lessons=200),
    recording=LoadShifts(rounds=10, ticks=600),
    batch=BatchLengths(robots=30, exam_s=60.0, batches=5, on_bus=6),
    batch_lessons=BatchLessonLengths(lesson_s=345.0, lessons=6, on_bus=2),
)
QUICK = Lengths(
    learning_s=90.0,
    turns=RealTimeTurns(rounds=4, ticks=125, reference_ticks=50),
    program=ProgramTurns(rounds=2, ticks=200, empty_ticks=100),
    sizes=tuple(Size(size.rlas, size.limit_us, size.calls // 4) for size in SIZES),
    loop_blocks=4,
    loop_block_s=20,
    lessons=50,
    channel=ChannelLengths(presses=15, shifts=LoadShifts(rounds=2, ticks=100), lessons=15),
    recording=LoadShifts(rounds=3, ticks=150),
    batch=BatchLengths(robots=6, exam_s=20.0, batches=3, on_bus=2),
    batch_lessons=BatchLessonLengths(lesson_s=60.0, lessons=3, on_bus=1),
)


class SuiteOutcome(NamedTuple):
    """Results of the benchmarks, and the errors of those that failed."""

    results: tuple[BenchResult, ...]
    errors: tuple[Exception, ...]
    """Each with the name of its benchmark as a note."""


async def run_suite(
    benches: Collection[BenchName],
    fixture: BenchFixture,
    folder: Path,
    lengths: Lengths,
    start_job: Callable[[str], OnProgress],
) -> SuiteOutcome:
    """Run the named benchmarks; files go to the empty `folder`. A benchmark that fails ends no other one.

    `start_job`: called with the name of a job, returns its progress callback.
    Raises the errors of `learn`: without a taught robot nothing is measured.
    """
    results: list[BenchResult] = []
    errors: list[Exception] = []

    @contextmanager
    def measuring(*names: BenchName) -> Iterator[None]:
        try:
            yield
        except Exception as error:  # noqa: BLE001 - it is raised when the other results are told
            error.add_note(f"bench {', '.join(names)}")
            errors.append(error)

    if any(bench is not BenchName.MATCH for bench in benches):
        fixture = await learn(fixture, lengths.learning_s, start_job("teaching, to have something to drive with"))
    if BenchName.LATENESS in benches or BenchName.TICK in benches:
        with measuring(BenchName.LATENESS, BenchName.TICK):
            run = await run_in_real_time(fixture, folder, lengths.turns, start_job("driving in real time"))
            if BenchName.LATENESS in benches:
                results.append(lateness_result(run))
            if BenchName.TICK in benches:
                results.extend(tick_results(run, fixture.settings.cycle_s))
    if BenchName.PROGRAM in benches:
        with measuring(BenchName.PROGRAM):
            started = start_job("running the program")
            results.extend(await measure_program(fixture, folder / "program", lengths.program, started))
    if BenchName.MATCH in benches:
        with measuring(BenchName.MATCH):
            results.extend(measure_match(lengths.sizes, start_job("matching")))
    if BenchName.LOOP in benches:
        with measuring(BenchName.LOOP):
            blocks, started = (lengths.loop_blocks, lengths.loop_block_s), start_job("driving in lockstep")
            results.extend(await measure_closed_loop(fixture, folder, *blocks, started))
    if BenchName.LESSON in benches:
        with measuring(BenchName.LESSON):
            started = start_job("making lessons durable")
            results.append(await measure_lessons(fixture, folder, lengths.lessons, started))
    if BenchName.CHANNEL in benches:
        with measuring(BenchName.CHANNEL):
            results.extend(await measure_channel(fixture, folder, lengths.channel, start_job))
    if BenchName.RECORDING in benches:
        with measuring(BenchName.RECORDING):
            started = start_job("driving, recorded and not")
            results.extend(await measure_recording(fixture, folder, lengths.recording, started))
    if BenchName.BATCH in benches:
        with measuring(BenchName.BATCH):
            results.extend(await measure_batch(fixture, lengths.batch, start_job("driving exams in a batch")))
            started = start_job("giving lessons in a batch")
            results.extend(await measure_batch_lessons(fixture, lengths.batch_lessons, started))
    return SuiteOutcome(tuple(results), tuple(errors))
