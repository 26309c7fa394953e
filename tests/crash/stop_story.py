"""A robot program that drives is halted by SIGSTOP for a while: the robot stands until it is told to drive."""

import signal
import time
from collections.abc import AsyncIterator, Iterable
from contextlib import ExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

import anyio
import can

from hal.bus import CanBus, open_bus
from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.teaching.commands import Resume, Take, Teach
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from tests.cli.three_programs import BRAKING_CYCLES, WATCHDOG_CYCLES, drives, is_control, stands, turns
from tests.crash.programs import Program
from tests.teacher.states_of import state_where

ON_THE_SPOT = "spin_left"
"""Action that turns the robot in place for ever."""
ROBOT = load_robot()
LONGEST_S = 240.0
LOOKED_ON_S = 0.6
"""Observation time after the program continues: six times the time that a wrong command would need."""
_LOOK_S = 0.005


@dataclass(frozen=True, slots=True)
class Stopped:
    """Frames on the bus around one stop of the program."""

    gap_s: float
    """Longest time between two CONTROL frames."""
    drove_on: int
    """CONTROL frames after it that told the wheels to turn."""
    most_at_once: int
    """Largest number of these frames within the maximum age of a command."""
    cycles_to_rest: int | None
    """Controller cycles from the last CONTROL frame to rest; None if the program continued before."""
    state: State
    """State on the teacher's device afterwards."""


class StopStory:
    """A robot that turns on the spot by what it was taught."""

    def __init__(self, program: Program, we: TeacherClient, bus: CanBus) -> None:
        self._program = program
        self._we = we
        self._bus = bus

    async def stop_for(self, seconds: float, *, until_it_rests: bool = False) -> Stopped:
        """Let it drive, stop its program for so long, let it go on, and look on.

        `until_it_rests`: for longer, if the wheels still turn then.
        """
        with anyio.fail_after(LONGEST_S):
            await self._drives()
            before = self._bus.drain()
            self._program.signal(signal.SIGSTOP)
            await anyio.sleep(seconds)
            meanwhile = self._bus.drain()
            while until_it_rests and _cycles_to_rest([*before, *meanwhile]) is None:
                await anyio.sleep(_LOOK_S)
                meanwhile += self._bus.drain()
            self._program.signal(signal.SIGCONT)
            after: list[can.Message] = []
            until_s = time.monotonic() + LOOKED_ON_S
            while time.monotonic() < until_s or not any(map(is_control, after)):
                await anyio.sleep(_LOOK_S)
                after += self._bus.drain()
            # The pictures from before the stop that waited in the network are not what is asked for.
            state = await state_where(self._we, lambda state: state.tick > self._tick)
            await self._seen_after_it(state)
        assert self._we.state is not None
        controls = [frame.timestamp for frame in [*before, *meanwhile] if is_control(frame)]
        first = next(frame for frame in after if is_control(frame))
        return Stopped(
            gap_s=first.timestamp - controls[-1],
            drove_on=sum(map(drives, after)),
            most_at_once=_most_within(ROBOT.guard.command_age_s, filter(drives, after)),
            cycles_to_rest=_cycles_to_rest([*before, *meanwhile]),
            state=self._we.state,
        )

    async def _drives(self) -> None:
        async for state in self._we.states():
            self._tick = state.tick
            if state.rla is not None and state.left_m_s < -0.1:
                return
            try:
                if state.teacher != self._we.name:
                    await self._we.send(Take)
                elif state.stopped:
                    await self._we.send(Resume)
                elif state.cause == "unknown":
                    await self._we.send(Teach, action=ON_THE_SPOT, decision_tick=state.tick)
            except NoAnswerError:
                continue

    async def _seen_after_it(self, seen: State) -> None:
        """Wait for some pictures more."""
        await state_where(self._we, lambda state: state.tick > seen.tick + 10)


def _most_within(span_s: float, frames: Iterable[can.Message]) -> int:
    times = sorted(frame.timestamp for frame in frames)
    return max((sum(begun_s <= each < begun_s + span_s for each in times) for begun_s in times), default=0)


def _cycles_to_rest(frames: list[can.Message]) -> int | None:
    """Return the controller cycles from the last CONTROL frame to rest, None without rest."""
    last = max(index for index, frame in enumerate(frames) if is_control(frame))
    turning = [turns(frame) for frame in frames[last:] if turns(frame) or stands(frame)]
    if not turning or turning[-1]:
        return None
    return max((number for number, turns_now in enumerate(turning, start=1) if turns_now), default=0)


MOST_CYCLES_TO_REST = WATCHDOG_CYCLES + BRAKING_CYCLES


@asynccontextmanager
async def a_robot_that_turns(folder: Path, bus: str) -> AsyncIterator[StopStory]:
    """Run a simulated robot that turns in place, its program and its teacher."""
    with ExitStack() as ending:
        sim = ending.enter_context(Program("sim", "--bus", bus, folder=folder, log=folder / "sim.log"))
        await sim.says("is on bus")
        end = open_bus(bus)
        ending.callback(end.shutdown)
        words = ("--bus", bus, "--port", "0", "--knowledge", str(folder / "knowledge"))
        program = ending.enter_context(Program("run", *words, folder=folder, log=folder / "run.log"))
        line = await program.says("teachers are listened to on UDP port")
        async with TeacherClient(folder / "var/devices/local", port=int(line.split()[-1])) as we:
            yield StopStory(program, we, end)
