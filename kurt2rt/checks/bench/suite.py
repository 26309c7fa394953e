"""Benchmarks in order, in one run."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

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


async def run_suite(
    benches: Collection[BenchName],
    fixture: BenchFixture,
    folder: Path,
    lengths: Lengths,
    start_job: Callable[[str], OnProgress],
) -> tuple[BenchResult, ...]:
    """Run the named benchmarks; files go to the empty `folder`.

    `start_job`: called with the name of a job, returns its progress callback.

    Raises:
        KnowledgeError, ChannelError, CredentialsError: the robot of a benchmark cannot be opened.
        LessonLostError: a lesson did not become durable.
        WrongWinnerError: the match differs from a brute force.
        HelperLostError: a helper process ended or did not answer.
        BatchRefusedError: the batch does not know the task.
        OSError: this machine has no timerfd, or the disk fails.
    """
    results: list[BenchResult] = []
    if any(bench is not BenchName.MATCH for bench in benches):
        fixture = await learn(fixture, lengths.learning_s, start_job("teaching, to have something to drive with"))
    if BenchName.LATENESS in benches or BenchName.TICK in benches:
        run = await run_in_real_time(fixture, folder, lengths.turns, start_job("driving in real time"))
        if BenchName.LATENESS in benches:
            results.append(lateness_result(run))
        if BenchName.TICK in benches:
            results.extend(tick_results(run, fixture.settings.cycle_s))
    if BenchName.PROGRAM in benches:
        results.extend(
            await measure_program(fixture, folder / "program", lengths.program, start_job("running the program"))
        )
    if BenchName.MATCH in benches:
        results.extend(measure_match(lengths.sizes, start_job("matching")))
    if BenchName.LOOP in benches:
        results.extend(
            await measure_closed_loop(
                fixture, folder, lengths.loop_blocks, lengths.loop_block_s, start_job("driving in lockstep")
            )
        )
    if BenchName.LESSON in benches:
        results.append(await measure_lessons(fixture, folder, lengths.lessons, start_job("making lessons durable")))
    if BenchName.CHANNEL in benches:
        results.extend(await measure_channel(fixture, folder, lengths.channel, start_job))
    if BenchName.RECORDING in benches:
        results.extend(
            await measure_recording(fixture, folder, lengths.recording, start_job("driving, recorded and not"))
        )
    if BenchName.BATCH in benches:
        results.extend(await measure_batch(fixture, lengths.batch, start_job("driving exams in a batch")))
        results.extend(
            await measure_batch_lessons(fixture, lengths.batch_lessons, start_job("giving lessons in a batch"))
        )
    return tuple(results)
