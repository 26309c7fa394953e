"""Benchmark of the loop's cost of connected teachers."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from statistics import fmean

from kurt2rt.channel.server.channel import STATES_PER_S
from kurt2rt.checks.bench.helper_process import helper_process
from kurt2rt.checks.bench.open_robot import OpenRobot, open_robot
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress
from kurt2rt.core.rla.phase import Phase
from kurt2rt.platform.ledger import Percentiles, TickTimer, percentiles_of

_SETTLING_S = 0.3


class Load(StrEnum):
    """Client of the robot."""

    ALONE = "leave"
    """No client; the channel has no part in the loop."""
    ONLOOKER = "look"
    """Client that receives state updates."""
    TEACHER = "watch"
    """Client that receives state updates and sends as often as in manual driving."""


@dataclass(frozen=True, slots=True)
class LoadShifts:
    """Number and length of the phases, which alternate so that disturbances of the machine affect all loads."""

    rounds: int
    ticks: int


@dataclass(frozen=True, slots=True)
class LoadPhase:
    """Measurements under one load."""

    seconds: float
    processor_us: float
    """Processor time of the robot's program with its simulated robot."""
    messages: int
    """Received messages."""
    missed_ticks: int

    @property
    def work_us(self) -> float:
        """Processor time per second, in µs."""
        return self.processor_us / self.seconds

    @property
    def messages_per_s(self) -> float:
        """Received messages per second."""
        return self.messages / self.seconds


@dataclass(frozen=True, slots=True)
class LoadPhases:
    """All phases of one load."""

    lateness: Percentiles
    each: tuple[LoadPhase, ...]

    @property
    def missed_ticks(self) -> int:
        """Missed ticks of all phases together."""
        return sum(phase.missed_ticks for phase in self.each)


async def measure_load(
    fixture: BenchFixture, folder: Path, shifts: LoadShifts, on_progress: OnProgress
) -> tuple[BenchResult, ...]:
    """Measure lateness and processor time of an autonomous robot under each load; files go to `folder`.

    Raises KnowledgeError, ChannelError, CredentialsError, HelperLostError, OSError without a timerfd.
    """
    ledgers = {load: TickTimer(shifts.rounds * shifts.ticks) for load in Load}
    phases: dict[Load, list[LoadPhase]] = {load: [] for load in Load}
    async with (
        open_robot(fixture, folder) as robot,
        helper_process("kurt2rt.checks.bench.device", *robot.address) as device,
    ):
        # The motion must not depend on the load.
        robot.runtime.handler.phase = Phase.AUTONOMOUS
        robot.runtime.handler.active_stop = None
        period_s = robot.runtime.robot.cycle_s
        for number in range(shifts.rounds):
            robot.pace.shift(period_s / shifts.rounds)
            for load in Load:
                robot.gate.open = True
                await device.ask(load.value)
                await _settle(robot, load)
                phases[load].append(await _measure_phase(robot, ledgers[load], shifts.ticks))
            on_progress((number + 1) / shifts.rounds)
    return load_results(
        {load: LoadPhases(ledgers[load].lateness(), tuple(phases[load])) for load in Load},
        period_s=period_s,
        driving_share=robot.gate.driving / robot.gate.ticks,
    )


async def _settle(robot: OpenRobot, load: Load) -> None:
    connected = load is not Load.ALONE
    await robot.gate.until(lambda: (robot.channel.observers > 0) is connected)
    robot.gate.open = connected
    await robot.gate.run_ticks(round(_SETTLING_S / robot.runtime.robot.cycle_s))


async def _measure_phase(robot: OpenRobot, ledger: TickTimer, ticks: int) -> LoadPhase:
    counters, runtime = robot.channel.endpoint.counters, robot.runtime
    missed, messages = runtime.timer.missed_ticks, counters.received
    processor_ns, begun_ns = time.process_time_ns(), time.monotonic_ns()
    robot.clock.ledger = ledger
    await robot.gate.run_ticks(ticks)
    robot.clock.ledger = None
    return LoadPhase(
        seconds=(time.monotonic_ns() - begun_ns) / 1e9,
        processor_us=(time.process_time_ns() - processor_ns) / 1e3,
        messages=counters.received - messages,
        missed_ticks=runtime.timer.missed_ticks - missed,
    )


def load_results(phases: dict[Load, LoadPhases], *, period_s: float, driving_share: float) -> tuple[BenchResult, ...]:
    """Return the lateness with a teacher, and the parts of the channel's processor time. Times in s and us."""
    alone, onlooker, teacher = (phases[load] for load in Load)
    late = Reference("alone, p99", alone.lateness.p99_us, teacher.lateness.p99_us)
    channel = _more(alone.each, teacher.each, [1.0] * len(teacher.each))
    other_us = percentiles_of([round(phase.work_us * 1e3) for phase in alone.each]).median_us
    picture = _more(alone.each, onlooker.each, [STATES_PER_S] * len(onlooker.each))
    more_messages = [
        taught.messages_per_s - looked.messages_per_s
        for looked, taught in zip(onlooker.each, teacher.each, strict=True)
    ]
    message = _more(onlooker.each, teacher.each, more_messages)
    return (
        BenchResult(
            "channel",
            "late, teacher there",
            teacher.lateness,
            late,
            (BenchGoal("missed", teacher.missed_ticks, 0),),
            f"{STATES_PER_S} pictures out, {fmean(more_messages):.0f} messages in per second; without "
            f"anybody {alone.missed_ticks} ticks missed; driving in {driving_share:.0%} of the ticks",
        ),
        BenchResult(
            "channel",
            "channel, per second",
            channel,
            Reference("all else", other_us, channel.median_us),
            note=f"{channel.median_us / 1e4:.1f} % of a core: processor time of the robot's program with a teacher, "
            "less that without anybody in the same round",
        ),
        BenchResult("channel", "  a picture", picture, Reference("period", period_s * 1e6, picture.median_us)),
        BenchResult("channel", "  a message", message, Reference("period", period_s * 1e6, message.median_us)),
    )


def _more(less: Sequence[LoadPhase], more: Sequence[LoadPhase], things_per_s: Sequence[float]) -> Percentiles:
    """Return the additional work per item, round by round."""
    return percentiles_of(
        [
            round((with_it.work_us - without.work_us) / per_s * 1e3)
            for without, with_it, per_s in zip(less, more, things_per_s, strict=True)
        ]
    )
