"""Benchmark of the loop's cost of recording, and of the recording's size."""

import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.checks.bench.channel_load import LoadShifts
from kurt2rt.checks.bench.lateness_clock import LatenessClock
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress, open_writer
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.ledger import Percentiles, TickTimer, percentiles_of
from kurt2rt.platform.switch_interval import short_switch_interval
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runs.recording.budget import budget_of
from kurt2rt.runs.recording.recording import Recording, RunContext
from kurt2rt.runs.recording.run_folder import used_bytes
from kurt2rt.runtime import Runtime, build_runtime

_BUDGET_MB = 1000
NOTE_LIMIT_US = 50.0


@dataclass(frozen=True, slots=True)
class RecordedStretch:
    """Time span with or without a recorder."""

    processor_us: float
    """Processor time of the robot's program with its simulated robot."""
    missed_ticks: int


@dataclass(frozen=True, slots=True)
class RecordedDrive:
    """Drive with every second stretch recorded."""

    period_s: float
    ticks: int
    """Ticks per stretch."""
    lateness: Percentiles
    alone_lateness: Percentiles
    note: Percentiles
    recorded: tuple[RecordedStretch, ...]
    alone: tuple[RecordedStretch, ...]
    bytes_written: int
    dropped: int
    trouble: str


async def measure_recording(
    fixture: BenchFixture, folder: Path, shifts: LoadShifts, on_progress: OnProgress
) -> tuple[BenchResult, ...]:
    """Drive autonomously, alternately with and without a recorder; files go to `folder`.

    Raises KnowledgeError, OSError without a timerfd.
    """
    return recording_results(await drive_recorded(fixture, folder, shifts, on_progress))


async def drive_recorded(
    fixture: BenchFixture, folder: Path, shifts: LoadShifts, on_progress: OnProgress
) -> RecordedDrive:
    """Drive, and return all measurements.

    Raises KnowledgeError, OSError without a timerfd.
    """
    runs = folder / "runs"
    settings, period_s = fixture.settings, fixture.settings.cycle_s
    recording = Recording(runs, budget_of(_BUDGET_MB), "sim")
    recorder = recording.recorder(settings, fixture.task, None, RunContext("bench", "", attended=False))
    ledgers = {recorded: TickTimer(shifts.rounds * shifts.ticks) for recorded in (False, True)}
    stretches: dict[bool, list[RecordedStretch]] = {False: [], True: []}
    noted_ns: list[int] = []

    with (
        closing(fixture.open_simulation("bench recording")) as simulation,
        open_writer(fixture, folder / "recording.knowledge") as writer,
        TimerfdClock() as timer,
        gc_frozen(),
        short_switch_interval(),
        recorder,
    ):
        clock = LatenessClock(timer)
        runtime = build_runtime(simulation.robot, settings, fixture.task, fixture.events, writer, clock)
        runtime.handler.phase = Phase.AUTONOMOUS
        callbacks = {False: _ignore, True: _timed(recorder.on_tick, noted_ns)}
        for number in range(shifts.rounds):
            with simulation.live():
                await timer.wait_until(timer.now_s() + period_s * number / shifts.rounds)
                for recorded, ledger in ledgers.items():
                    clock.ledger = ledger
                    stretches[recorded].append(await _stretch(runtime, callbacks[recorded], shifts.ticks))
                    clock.ledger = None
            on_progress((number + 1) / shifts.rounds)
    return RecordedDrive(
        period_s=period_s,
        ticks=shifts.ticks,
        lateness=ledgers[True].lateness(),
        alone_lateness=ledgers[False].lateness(),
        note=percentiles_of(noted_ns),
        recorded=tuple(stretches[True]),
        alone=tuple(stretches[False]),
        bytes_written=used_bytes(runs),
        dropped=recorder.dropped,
        trouble=recorder.trouble,
    )


async def _stretch(runtime: Runtime, after_tick: Callable[[TickRecord], None], ticks: int) -> RecordedStretch:
    missed, processor_ns = runtime.timer.missed_ticks, time.process_time_ns()
    await runtime.scheduler.run(ticks, after_tick)
    return RecordedStretch((time.process_time_ns() - processor_ns) / 1e3, runtime.timer.missed_ticks - missed)


def _timed(on_tick: Callable[[TickRecord], None], took_ns: list[int]) -> Callable[[TickRecord], None]:
    """Return a callback that appends the duration of each call of `on_tick` to `took_ns`."""

    def timed(record: TickRecord) -> None:
        begun_ns = time.perf_counter_ns()
        on_tick(record)
        took_ns.append(time.perf_counter_ns() - begun_ns)

    return timed


def _ignore(_: TickRecord) -> None:
    """Ignore the tick."""


def recording_results(drive: RecordedDrive) -> tuple[BenchResult, ...]:
    """Return the lateness while recording, the time of a note, and the recorder thread's work."""
    stretch_s = drive.ticks * drive.period_s
    pairs = list(zip(drive.alone, drive.recorded, strict=True))
    more = percentiles_of([round((each.processor_us - alone.processor_us) / stretch_s * 1e3) for alone, each in pairs])
    alone_us = percentiles_of([round(alone.processor_us / stretch_s * 1e3) for alone in drive.alone]).median_us
    hours = len(drive.recorded) * stretch_s / 3600
    missed = sum(each.missed_ticks for each in drive.recorded)
    missed_alone = sum(each.missed_ticks for each in drive.alone)
    return (
        BenchResult(
            "recording",
            "late, recorded",
            drive.lateness,
            Reference("alone, p99", drive.alone_lateness.p99_us, drive.lateness.p99_us),
            (BenchGoal("missed", missed, 0), BenchGoal("lost", drive.dropped, 0)),
            drive.trouble or f"without a recorder {missed_alone} ticks missed",
        ),
        BenchResult(
            "recording",
            "  a note, in the loop",
            drive.note,
            Reference("period", drive.period_s * 1e6, drive.note.median_us),
            (BenchGoal("p99 us", drive.note.p99_us, NOTE_LIMIT_US),),
        ),
        BenchResult(
            "recording",
            "  writing, per second",
            more,
            Reference("all else", alone_us, more.median_us),
            note=f"{more.median_us / 1e4:.1f} % of a core: processor time with a recorder, less that without one in "
            f"the same round; {drive.bytes_written / 1e6 / hours:.0f} MB an hour",
        ),
    )
