"""Benchmark of the time until a lesson is durable."""

import random
import time
from functools import partial
from pathlib import Path

import anyio
from anyio import to_thread

from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import SEED, BenchFixture, OnProgress, open_writer
from kurt2rt.core.teaching.commands import Teach
from kurt2rt.core.tick import TickRecord
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from kurt2rt.platform.fsync_probe import fsync_ns
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.ledger import percentiles_of
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runtime import build_runtime

P99_LIMIT_US = 20_000.0


async def measure_lessons(
    fixture: BenchFixture, folder: Path, lessons: int, on_progress: OnProgress, patience_s: float = 10.0
) -> BenchResult:
    """Measure the time from a command through the tick to the durable journal in `folder`.

    Alternates with a bare fsync there. Times in s. Raises LessonLostError, KnowledgeError, OSError without a timerfd.
    """
    period_s = fixture.settings.can.cycle_s
    chance = random.Random(SEED)
    took_ns: list[int] = []
    syncs_ns: list[int] = []
    simulation = fixture.open_simulation("bench lesson")
    try:
        with (
            open_writer(fixture, folder / "lesson.knowledge") as writer,
            (folder / "sync").open("wb", buffering=0) as file,
            TimerfdClock() as clock,
            simulation.live(),
            gc_frozen(),
        ):
            runtime = build_runtime(simulation.robot, fixture.settings, fixture.task, fixture.events, writer, clock)
            actions = tuple(runtime.level.repertoire)
            taken = anyio.Event()

            def after_tick(record: TickRecord) -> None:
                if record.results:
                    taken.set()

            async with anyio.create_task_group() as tasks:
                tasks.start_soon(partial(runtime.scheduler.run, None, after_tick))
                for number in range(lessons):
                    syncs_ns.append(await to_thread.run_sync(fsync_ns, file))
                    # The teacher does not know when ticks begin.
                    await anyio.sleep(chance.uniform(0.0, 2 * period_s))
                    taken = anyio.Event()
                    begun_ns = time.perf_counter_ns()
                    # In turns, so that one where the robot stands still is never what the robot knows already.
                    runtime.inbox.put(Teach(f"bench-lesson-{number}", "bench", actions[number % 2]))
                    await taken.wait()
                    if not await to_thread.run_sync(writer.flush, patience_s):
                        break
                    took_ns.append(time.perf_counter_ns() - begun_ns)
                    on_progress((number + 1) / lessons)
                runtime.scheduler.end()
            durable = sum(each.sequence is not None for each in writer.acknowledged())
            if durable < lessons:
                why = writer.saving_error or f"{folder}: the disk did not answer within {patience_s:g} s"
                raise LessonLostError(f"{durable} of {lessons} lessons became durable: {why}")
    finally:
        simulation.close()
    took = percentiles_of(took_ns)
    return BenchResult(
        "lesson",
        "lesson durable",
        took,
        Reference("bare fsync", percentiles_of(syncs_ns).median_us, took.median_us),
        (BenchGoal("p99 us", took.p99_us, P99_LIMIT_US),),
        f"{lessons} lessons, the wait for the next tick ({period_s * 500:g} ms on average) included",
    )
