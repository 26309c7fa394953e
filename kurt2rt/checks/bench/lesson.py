"""Benchmark of the time until a lesson is durable."""

import random
import time
from collections.abc import Callable
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import NamedTuple

import anyio
from anyio import to_thread

from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import SEED, BenchFixture, OnProgress, open_writer
from kurt2rt.core.teaching.commands import Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.platform.fsync_probe import fsync_ns
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.ledger import percentiles_of
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runtime import Runtime, build_runtime

P99_LIMIT_US = 20_000.0


async def measure_lessons(
    fixture: BenchFixture, folder: Path, lessons: int, on_progress: OnProgress, patience_s: float = 10.0
) -> BenchResult:
    """Measure the time from a command through the tick to the durable journal in `folder`.

    Alternates with a bare fsync there. Times in s. Raises LessonLostError, KnowledgeError, OSError without a timerfd.
    """
    with (
        closing(fixture.open_simulation("bench lesson")) as simulation,
        open_writer(fixture, folder / "lesson.knowledge") as writer,
        (folder / "sync").open("wb", buffering=0) as file,
        TimerfdClock() as clock,
        simulation.live(),
        gc_frozen(),
    ):
        runtime = build_runtime(simulation.robot, fixture.settings, fixture.task, fixture.events, writer, clock)
        timer = _LessonTimer(runtime, writer, patience_s)
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(partial(runtime.scheduler.run, None, timer.after_tick))
            times = await timer.alternate(lessons, partial(fsync_ns, file), on_progress)
            runtime.scheduler.end()
        if times is None:
            raise LessonLostError(writer.saving_error or f"{folder}: the disk did not answer within {patience_s:g} s")
    return _lesson_result(times, fixture.settings.cycle_s)


class _LessonTimes(NamedTuple):
    """Times in nanoseconds."""

    lessons: list[int]
    syncs: list[int]


class _LessonTimer:
    """Teacher of a running robot that waits until each of its lessons is durable."""

    def __init__(self, runtime: Runtime, writer: JournalWriter, patience_s: float) -> None:
        self._runtime = runtime
        self._writer = writer
        self._patience_s = patience_s
        self._taken = anyio.Event()
        self._is_lesson = False

    def after_tick(self, record: TickRecord) -> None:
        """Notice the tick that carried the answer out, and whether it was a lesson."""
        if record.results:
            self._is_lesson = any(each.lesson for each in record.results)
            self._taken.set()

    async def alternate(self, lessons: int, sync_ns: Callable[[], int], on_progress: OnProgress) -> _LessonTimes | None:
        """Measure a bare fsync and a lesson in turns; return None if a lesson does not become durable in time.

        An answer that says what the robot knows already is no lesson, and another one follows.
        """
        period_s = self._runtime.robot.cycle_s
        chance = random.Random(SEED)
        actions = tuple(self._runtime.level.repertoire)
        times = _LessonTimes([], [])
        number = 0
        while len(times.lessons) < lessons:
            times.syncs.append(await to_thread.run_sync(sync_ns))
            # The teacher does not know when ticks begin.
            await anyio.sleep(chance.uniform(0.0, 2 * period_s))
            self._taken = anyio.Event()
            begun_ns = time.perf_counter_ns()
            # In turns, because an answer that was just given is known.
            self._runtime.inbox.put(Teach(f"bench-lesson-{number}", "bench", actions[number % 2]))
            await self._taken.wait()
            number += 1
            if not self._is_lesson:
                continue
            if not await to_thread.run_sync(self._writer.flush, self._patience_s):
                return None
            times.lessons.append(time.perf_counter_ns() - begun_ns)
            on_progress(len(times.lessons) / lessons)
        return times


def _lesson_result(times: _LessonTimes, period_s: float) -> BenchResult:
    took = percentiles_of(times.lessons)
    return BenchResult(
        "lesson",
        "lesson durable",
        took,
        Reference("bare fsync", percentiles_of(times.syncs).median_us, took.median_us),
        (BenchGoal("p99 us", took.p99_us, P99_LIMIT_US),),
        f"{len(times.lessons)} lessons, the wait for the next tick ({period_s * 500:g} ms on average) included",
    )
