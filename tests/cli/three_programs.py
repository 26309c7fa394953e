"""Robot, runtime and teacher as three programs that meet on a bus and over UDP, and one that looks on at the bus."""

import math
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from pathlib import Path

import anyio
import anyio.to_thread
import can

from hal.bus import CONTROL_ID, CanBus, open_bus
from hal.codec import load_codec
from hal.control import RawControl, decode_control
from hal.kurt2_settings import load_kurt2
from kurt2rt.core.decision.standing import STARTED
from kurt2rt.core.teaching.commands import Resume, Take, Teach
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import NoAnswerError
from tests.cli.helpers import Running, running
from tests.teacher.states_of import state_where

ROBOT = load_kurt2()
CODEC = load_codec()
ENCODER = CODEC.message("ENCODER")
WATCHDOG_CYCLES = round(ROBOT.motors.controller_watchdog_s / ROBOT.cycle_s)
BRAKING_CYCLES = 30
"""Cycles that braking takes: 20 from the guard's limit of 0.6 m/s at 3 m/s², and some for the speed loop."""
LONG_ENOUGH_S = 120.0
"""Longest wait of a test, in s; the test fails then."""
_LOOK_S = 0.005


class Onlooker:
    """Observer of a bus that keeps its frames."""

    def __init__(self, bus: CanBus) -> None:
        self._bus = bus
        self.frames: list[can.Message] = []

    async def until(self, enough: Callable[[can.Message], bool]) -> list[can.Message]:
        """Wait for a frame that the predicate accepts; return the frames since the last call, up to this one."""
        seen: list[can.Message] = []
        with anyio.fail_after(LONG_ENOUGH_S):
            while True:
                while self.frames:
                    seen.append(self.frames.pop(0))
                    if enough(seen[-1]):
                        return seen
                await anyio.sleep(_LOOK_S)  # a bus does not notify of frames
                self.look()

    def look(self) -> None:
        """Keep what passed until now."""
        self.frames += self._bus.drain()

    def forget(self) -> None:
        """Drop the frames that passed until now."""
        self._bus.drain()
        self.frames.clear()


@contextmanager
def onlooker(bus: str) -> Iterator[Onlooker]:
    """Observe a bus that exists."""
    end = open_bus(bus)
    try:
        yield Onlooker(end)
    finally:
        end.shutdown()


def is_control(frame: can.Message) -> bool:
    return frame.arbitration_id == CONTROL_ID and not (
        frame.is_error_frame or frame.is_extended_id or frame.is_remote_frame
    )


def drives(frame: can.Message) -> bool:
    """Return whether a frame tells the wheels to turn."""
    if not is_control(frame):
        return False
    control = decode_control(frame.data)
    speeds = control.wheel_speeds(ROBOT.motors) if not hasattr(control, "angle_urad") else (0.0, 0.0)
    return speeds != (0.0, 0.0)


def brakes(frame: can.Message) -> bool:
    """Return whether a frame tells both wheels to brake."""
    if not is_control(frame):
        return False
    control = decode_control(frame.data)
    return isinstance(control, RawControl) and control.left.brake and control.right.brake


def turns(frame: can.Message) -> bool:
    """Return whether a frame says that the wheels turn."""
    return frame.arbitration_id == ENCODER.frame_id and ENCODER.unpack(frame.data) != (0, 0)


def stands(frame: can.Message) -> bool:
    """Return whether a frame says that the wheels stand."""
    return frame.arbitration_id == ENCODER.frame_id and ENCODER.unpack(frame.data) == (0, 0)


@contextmanager
def runtime(bus: str, folder: Path, *words: str) -> Iterator[Running]:
    """Start `kurt2rt run` on a bus, in a folder; kill it at the end."""
    with running("run", "--bus", bus, "--port", "0", "--knowledge", "mine.knowledge", *words, folder=folder) as robot:
        yield robot


@asynccontextmanager
async def teacher_of(robot: Running, folder: Path) -> AsyncIterator[TeacherClient]:
    """Connect a teacher to the robot program as soon as it listens."""
    line = await anyio.to_thread.run_sync(robot.wait_for, "teachers are listened to on UDP port")
    async with TeacherClient(folder / "var/devices/local", port=int(line.split()[-1])) as teacher:
        yield teacher


async def teach_kill_and_return(bus: str, folder: Path) -> int:
    """Teach the robot until it drives, kill its program, wait for standstill, start the program again.

    Returns the number of controller cycles from the last CONTROL frame until the wheels stood.
    """
    with running("sim", "--bus", bus, "--start", "1", folder=folder) as sim, onlooker(bus) as seen:
        await anyio.to_thread.run_sync(sim.wait_for, f"is on bus {bus}")
        with runtime(bus, folder) as robot:
            async with teacher_of(robot, folder) as we:
                assert (await we.send(Take)).accepted
                stopped = await state_where(we, lambda state: state.teacher == "local")
                assert stopped.stopped == STARTED
                lessons = await until_it_drives(we)
                await seen.until(turns)
                seen.forget()
                robot.process.kill()
                cycles = await _cycles_to_rest(seen)
        await anyio.to_thread.run_sync(sim.wait_for, "CONTROL has ceased: the watchdog brakes")
        with runtime(bus, folder) as robot:  # as a supervisor does
            async with teacher_of(robot, folder) as we:
                back = await state_where(we, lambda state: not math.isinf(state.infrared_age_s))
                assert (back.action, back.unsaved, back.stopped) == (None, 0, STARTED)
                assert back.lessons >= lessons  # one that was not acknowledged may be there as well
                assert (await we.lessons())[-1].teacher == "local"
                assert (await we.send(Take)).accepted
                await until_it_drives(we)
    return cycles


async def until_it_drives(we: TeacherClient, action: str = "forward") -> int:
    """Resume and answer questions with that action until the robot drives by its RLAs; return the number of lessons.

    Again and again: on a machine that has much to do at the same time the guard may stop it now and then.
    """
    lessons = 0
    with anyio.fail_after(LONG_ENOUGH_S):
        async for state in we.states():
            if state.rla is not None and abs(state.left_m_s) > 0.1:
                return lessons
            with suppress(NoAnswerError):
                if state.stopped:
                    await we.send(Resume)
                elif state.cause == "unknown":
                    lessons += (await we.send(Teach, action=action, decision_tick=state.tick)).accepted
    raise AssertionError("the client ended")


async def _cycles_to_rest(seen: Onlooker) -> int:
    """Return the controller cycles from the last CONTROL frame of a killed program until the wheels stand."""
    turned: list[bool] = []

    def at_rest(frame: can.Message) -> bool:
        if is_control(frame):
            turned.clear()  # there are some that the program sent before
        elif turns(frame) or stands(frame):
            turned.append(turns(frame))
        return len(turned) > WATCHDOG_CYCLES and not turned[-1]

    await seen.until(at_rest)
    return max((cycle + 1 for cycle, turning in enumerate(turned) if turning), default=0)
