"""Benchmark of the robot's program in real time: the whole service, its simulated robot in a process of its own."""

import os
import resource
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

import anyio
import numpy as np
from numpy.typing import NDArray

from hal.bus import open_bus
from hal.kurt2 import Kurt2
from kurt2rt.channel.security.pairing import local_pairing
from kurt2rt.checks.bench.helper_process import HelperLostError, helper_process
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import SEED, BenchFixture, OnProgress, open_writer
from kurt2rt.checks.bench.tick_budget import share_result
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.teaching.commands import Command, SetPhase
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.ledger import TickTimer, percentiles_of
from kurt2rt.platform.scheduler import Scheduler
from kurt2rt.platform.switch_interval import short_switch_interval
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runs.recording.budget import budget_of
from kurt2rt.runs.recording.recording import Recording
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.health.probes import Probes
from kurt2rt.service.post_tick import ProgramConsole
from kurt2rt.service.serve import ChannelOptions, ServeOptions, serve
from kurt2rt.service.settings import load_service

PERCENT_LIMIT = 5.0
"""Asked of the program without a teacher, in percent of a core."""
_BUDGET_MB = 1000
_WARM_UP_TICKS = 100
"""Ticks of each round before the measured ones: the program starts in them."""
_PATIENCE_S = 30.0


@dataclass(frozen=True, slots=True)
class ProgramTurns:
    """Lengths of the alternating turns of the program and of an empty loop."""

    rounds: int
    ticks: int
    """Measured ticks of the program per round."""
    empty_ticks: int
    """Ticks of the empty loop per round."""


@dataclass(frozen=True, slots=True)
class ProcessorUse:
    """Processor time and context switches of this process, all threads together."""

    user_us: float
    system_us: float
    waited: int
    """Switches because a thread waited."""
    preempted: int
    """Switches because another thread or process had precedence."""
    ticks: int = 0

    def since(self, before: "ProcessorUse") -> "ProcessorUse":
        """Return the use between two readings."""
        return ProcessorUse(
            self.user_us - before.user_us,
            self.system_us - before.system_us,
            self.waited - before.waited,
            self.preempted - before.preempted,
            self.ticks - before.ticks,
        )

    @property
    def tick_us(self) -> float:
        """Processor time of a tick, in µs."""
        return (self.user_us + self.system_us) / self.ticks


@dataclass(frozen=True, slots=True)
class ProgramDrive:
    """Measurements of all rounds."""

    program: tuple[ProcessorUse, ...]
    empty: tuple[ProcessorUse, ...]
    tick_ns: NDArray[np.int64]
    """Time of the stages of each measured tick."""
    missed_ticks: int
    driving: int
    """Measured ticks in which an action drove the wheels."""


def read_use(ticks: int = 0) -> ProcessorUse:
    """Return the use of this process so far, with the number of its `ticks`."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return ProcessorUse(used.ru_utime * 1e6, used.ru_stime * 1e6, used.ru_nvcsw, used.ru_nivcsw, ticks)


async def measure_program(
    fixture: BenchFixture, folder: Path, turns: ProgramTurns, on_progress: OnProgress
) -> tuple[BenchResult, ...]:
    """Measure the service without a teacher, recorded, as it drives by its knowledge; files go to `folder`.

    Raises KnowledgeError, ChannelError, CredentialsError, HelperLostError, OSError without a timerfd.
    """
    drive = await drive_program(fixture, folder, turns, on_progress)
    return program_results(drive, fixture.settings.cycle_s)


async def drive_program(
    fixture: BenchFixture, folder: Path, turns: ProgramTurns, on_progress: OnProgress
) -> ProgramDrive:
    """Drive, alternating with an empty loop, and return all measurements (`measure_program`)."""
    bus, period_s = f"shared:bench-{os.getpid()}", fixture.settings.cycle_s
    local_pairing(folder / "teachers", folder / "devices")
    with open_writer(fixture, folder / "program.knowledge"):
        pass
    simulator = ("sim", "--bus", bus, "--world", fixture.task.teaching.world, "--seed", str(SEED), "--while-stdin")
    program, empty, ticks_ns = [], [], []
    missed = driving = 0
    with ExitStack() as stack:
        robot = Kurt2(fixture.settings, open_bus(bus))
        stack.callback(robot.close)
        async with helper_process("kurt2rt.cli.main", *simulator):
            await _wait_for(robot, period_s)
            for number in range(turns.rounds):
                meter = _Meter(turns.ticks)
                timer = await _serve(robot, fixture, folder, meter)
                program.append(meter.use)
                ticks_ns.append(timer.ticks_ns()[-turns.ticks :])
                missed += timer.missed_ticks
                driving += meter.driving
                empty.append(await _tick_empty(turns.empty_ticks, period_s))
                on_progress((number + 1) / turns.rounds)
    return ProgramDrive(tuple(program), tuple(empty), np.concatenate(ticks_ns), missed, driving)


class _Meter:
    """Callback in each tick of a round: sets the phase, and reads the processor's time at both ends of the round."""

    def __init__(self, ticks: int) -> None:
        self.last_tick = _WARM_UP_TICKS + ticks
        self.driving = 0
        self._ticks = 0
        self._begin: ProcessorUse | None = None
        self._end: ProcessorUse | None = None

    @property
    def use(self) -> ProcessorUse:
        """Use between the warm-up and the newest tick."""
        assert self._begin is not None
        assert self._end is not None
        return self._end.since(self._begin)

    def __call__(self, record: TickRecord) -> Command | None:
        """Count a tick; return the command that lets the robot drive without a teacher in the first one."""
        if record.number == 1:
            return SetPhase("bench-phase", "bench", Phase.AUTONOMOUS)
        if record.tick > _WARM_UP_TICKS:
            if self._begin is None:
                self._begin = read_use()
                return None
            self._ticks += 1
            self.driving += record.decision.driving
            if record.tick >= self.last_tick or self._end is None:
                self._end = read_use(self._ticks)
        return None


async def _serve(robot: Kurt2, fixture: BenchFixture, folder: Path, meter: _Meter) -> TickTimer:
    """Run the service for one round, and return the timer of its ticks."""
    service = load_service().model_copy(
        update={"knowledge": str(folder / "program.knowledge"), "teachers": str(folder / "teachers"), "port": 0}
    )
    recording = Recording(folder / "runs", budget_of(_BUDGET_MB), "bench")
    options = ServeOptions(
        on_tick=meter,
        channel=ChannelOptions(),
        duration_s=(meter.last_tick + 1) * fixture.settings.cycle_s,
        probes=Probes(lambda: robot.health),
        recording=recording,
    )
    silent: Callable[[object], None] = lambda _: None  # noqa: E731
    console = ProgramConsole(status=silent, question=silent, acknowledged=silent)
    robot.release()
    with robot.watchdog:
        last = await serve(robot, RunSettings(fixture.settings, fixture.task, service), console, options)
    assert last is not None
    return last.runtime.timer


async def _tick_empty(ticks: int, period_s: float) -> ProcessorUse:
    """Run the loop of the service with a tick that does nothing; return its use."""
    with TimerfdClock() as clock, gc_frozen(), short_switch_interval():
        timer = TickTimer()
        scheduler = Scheduler(clock, lambda _tick, _now_s: None, period_s, timer)
        before = read_use()
        await scheduler.run(ticks, lambda _: None)
        return read_use(timer.ticks).since(before)


async def _wait_for(robot: Kurt2, period_s: float) -> None:
    """Wait for the readings of the robot. Raises HelperLostError after half a minute without one."""
    ends_s = anyio.current_time() + _PATIENCE_S
    while not robot.sense(anyio.current_time()).infrared_age_s < 1.0:
        if anyio.current_time() > ends_s:
            raise HelperLostError(f"the simulated robot sent nothing for {_PATIENCE_S:g} s; see above why")
        await anyio.sleep(period_s)


def program_results(drive: ProgramDrive, period_s: float) -> tuple[BenchResult, ...]:
    """Return the processor time of the program per tick, and the time of its ticks; `period_s`: of a tick, in s."""
    used = percentiles_of([round(each.tick_us * 1e3) for each in drive.program])
    empty_us = percentiles_of([round(each.tick_us * 1e3) for each in drive.empty]).median_us
    percent = used.median_us / (period_s * 1e4)
    ticks = sum(each.ticks for each in drive.program)

    def a_tick(of: Callable[[ProcessorUse], float]) -> float:
        return fmean(of(each) / each.ticks for each in drive.program)

    whole = BenchResult(
        "program",
        "program, processor a tick",
        used,
        Reference("empty loop", empty_us, used.median_us),
        (BenchGoal("% of a core", percent, PERCENT_LIMIT),),
        f"{percent:.1f} % of a core without a teacher, recorded, by the median of {len(drive.program)} rounds; {ticks} "
        f"ticks, {drive.missed_ticks} missed, {drive.driving / ticks:.0%} driving; a tick takes "
        f"{a_tick(lambda use: use.user_us):.0f} us user and {a_tick(lambda use: use.system_us):.0f} us system, waits "
        f"{a_tick(lambda use: use.waited):.1f} times, is preempted {a_tick(lambda use: use.preempted):.2f} times",
    )
    tick = percentiles_of(drive.tick_ns)
    note = f"{len(drive.tick_ns)} ticks at 100 Hz with cold caches; the robot is simulated in a process of its own"
    return (whole, share_result("program", "  of it the tick", tick, period_s, note))
