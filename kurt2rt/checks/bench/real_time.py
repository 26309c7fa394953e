"""Drive in real time with the whole runtime, alternating with a bare asyncio.sleep loop."""

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.checks.bench.robot_under_test import SEED, BenchFixture, OnProgress, open_writer
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.asyncio_clock import AsyncioClock
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.ledger import Percentiles, Stage, TickTimer
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runtime import build_runtime
from kurt2rt.teacher.scripted.basic_teacher import view_of_tick
from kurt2rt.teacher.scripted.build import build_teacher


@dataclass(frozen=True, slots=True)
class RealTimeTurns:
    """Lengths of the alternating turns of runtime and reference, so that disturbances affect both."""

    rounds: int
    ticks: int
    """Ticks of the runtime per round."""
    reference_ticks: int
    """Ticks of the bare loop per round."""


@dataclass(frozen=True, slots=True)
class RealTimeRun:
    """Timing of a drive."""

    ticks: int
    """Length of the run in ticks, including missed ones."""
    missed_ticks: int
    driving_share: float
    """Share of ticks in which an action drove the wheels."""
    rlas: int
    """RLAs at the end."""
    lateness: Percentiles
    asyncio_lateness: Percentiles
    """Lateness of the bare loop."""
    tick: Percentiles
    stages: dict[Stage, Percentiles]


async def run_in_real_time(
    fixture: BenchFixture, folder: Path, turns: RealTimeTurns, on_progress: OnProgress
) -> RealTimeRun:
    """Drive as the service does, with its journal in `folder`, and return the measurements.

    Raises KnowledgeError, OSError without a timerfd.
    """
    period_s = fixture.settings.cycle_s
    asyncio_ledger = TickTimer()
    driving = 0
    with (
        closing(fixture.open_simulation("bench real_time")) as simulation,
        open_writer(fixture, folder / "real_time.knowledge") as writer,
        TimerfdClock() as clock,
        gc_frozen(),
    ):
        runtime = build_runtime(simulation.robot, fixture.settings, fixture.task, fixture.events, writer, clock)
        actions = tuple(runtime.level.repertoire)
        teacher = build_teacher(fixture.task, fixture.settings, actions, seed=SEED, session="bench")
        runtime.inbox.put(teacher.begin_phase(Phase.CORRECTIONS))

        def after_tick(record: TickRecord) -> None:
            nonlocal driving
            driving += record.decision.driving
            command = teacher.update(view_of_tick(record))
            if command is not None:
                runtime.inbox.put(command)
            if record.tick % round(1 / period_s) == 0:
                counted = runtime.statistics
                writer.submit_statistics(Statistics(dict(counted.uses), dict(counted.transitions)))

        for number in range(turns.rounds):
            with simulation.live():
                # The controller's cycle and ours are not in step: each round meets another phase of it.
                await clock.wait_until(clock.now_s() + period_s * number / turns.rounds)
                await runtime.scheduler.run(turns.ticks, after_tick)
            await sleep_bare(AsyncioClock(), turns.reference_ticks, period_s, asyncio_ledger)
            # Only here: drawing a progress bar takes milliseconds that would show as lateness.
            on_progress((number + 1) / turns.rounds)
    ledger = runtime.timer
    return RealTimeRun(
        ticks=turns.rounds * turns.ticks,
        missed_ticks=ledger.missed_ticks,
        driving_share=driving / max(1, ledger.ticks),
        rlas=len(runtime.level.system),
        lateness=ledger.lateness(),
        asyncio_lateness=asyncio_ledger.lateness(),
        tick=ledger.tick(),
        stages={stage: ledger.stage(stage) for stage in Stage},
    )


async def sleep_bare(clock: Clock, ticks: int, period_s: float, ledger: TickTimer) -> None:
    """Sleep to `ticks` multiples of the period in s, and record in `ledger` how late each sleep ended."""
    start_s = clock.now_s()
    number = 0
    for _ in range(ticks):
        number = max(number, int((clock.now_s() - start_s) / period_s)) + 1
        deadline_s = start_s + number * period_s
        await clock.wait_until(deadline_s)
        ledger.begin(clock.now_s() - deadline_s)
        ledger.end()
