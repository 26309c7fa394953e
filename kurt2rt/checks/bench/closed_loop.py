"""Benchmark of a lesson in lockstep on one core: world, codec, bus, runtime and teacher."""

import os
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import SEED, BenchFixture, OnProgress, open_writer, with_duration
from kurt2rt.checks.bench.tick_budget import share_result
from kurt2rt.experiments.lockstep.lesson import teach
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.platform.ledger import percentiles_of

TIMES_REAL_TIME = 60.0


async def measure_closed_loop(
    fixture: BenchFixture, folder: Path, blocks: int, seconds_per_block: int, on_progress: OnProgress
) -> tuple[BenchResult, ...]:
    """Return the time per tick of a lesson that goes on from the fixture's knowledge, and the runtime's share of it.

    Timed by `blocks` of `seconds_per_block` whole simulated seconds. The journal goes to `folder`. Raises
    KnowledgeError.
    """
    period_s = fixture.settings.cycle_s
    ticks_per_block = round(seconds_per_block / period_s)
    # One second ahead of the first block, for all that is slow but once.
    task = with_duration(fixture.task, supervised_s=period_s, corrections_s=1 + blocks * seconds_per_block - period_s)
    tick_ns: list[int] = []
    begun_ns = seconds = 0

    def after_second(_: float) -> None:
        nonlocal begun_ns, seconds
        blocks_done, within = divmod(seconds, seconds_per_block)
        seconds += 1
        if within > 0:
            return
        if blocks_done > 0:
            tick_ns.append((time.perf_counter_ns() - begun_ns) // ticks_per_block)
            on_progress(blocks_done / blocks)
        begun_ns = time.perf_counter_ns()

    with (
        closing(fixture.open_simulation("bench closed_loop")) as simulation,
        on_one_core() as core,
        open_writer(fixture, folder / "closed_loop.knowledge") as writer,
    ):
        training = TrainingStore(writer, fixture.events)
        lesson = await teach(simulation, fixture.settings, task, training, seed=SEED, on_progress=after_second)
    tick = percentiles_of(tick_ns)
    reference = Reference("period", period_s * 1e6, tick.median_us)
    best = period_s * 1e9 / min(tick_ns)
    loop = BenchResult(
        "loop",
        "closed loop, a tick",
        tick,
        reference,
        (BenchGoal("ratio", reference.ratio, TIMES_REAL_TIME, at_least=True),),
        f"{blocks} blocks of {ticks_per_block} ticks on core {core}: median {reference.ratio:.1f} times real time, "
        f"best {best:.1f}; {len(lesson.rlas)} RLAs",
    )
    return (loop, share_result("loop", "  of it the runtime", lesson.ledger.tick(), period_s, "no physics in it"))


@contextmanager
def on_one_core() -> Iterator[int]:
    """Restrict this thread and its children to one of its allowed cores; yield the core."""
    before = os.sched_getaffinity(0)
    core = max(before)  # interrupts mostly come to the first one
    os.sched_setaffinity(0, {core})
    try:
        yield core
    finally:
        os.sched_setaffinity(0, before)
