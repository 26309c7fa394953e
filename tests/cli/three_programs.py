"""Robot, runtime and teacher as three programs that meet on a bus and over UDP, and one that looks on at the bus."""

import math
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

import anyio
import anyio.to_thread
import can

from hal.bus import CONTROL_ID, CanBus, open_bus
from hal.codec import load_codec
from hal.control import RawControl, decode_control
from hal.robot_settings import load_robot
from kurt2rt.channel.state import State
from kurt2rt.teaching import TeacherClient
from kurt2rt.teaching.answer import NoAnswerError
from tests.cli.helpers import Running, running

ROBOT = load_robot()
CODEC = load_codec()
ENCODER = CODEC.message("ENCODER")
WATCHDOG_CYCLES = round(ROBOT.motors.controller_watchdog_s / ROBOT.can.cycle_s)
BRAKING_CYCLES = 30
"""From the fastest that the guard allows, 0.6 m/s at 3 m/s², it takes 20 cycles, and some for the speed loop."""
LONG_ENOUGH_S = 60.0
"""For whatever a test waits for; it fails then."""
_LOOK_S = 0.005
_SILENT_CYCLES = 30
_STARTED = "the robot program was started"


class Onlooker:
    """Somebody who looks on at a bus, and keeps what passes."""

    def __init__(self, bus: CanBus) -> None:
        self._bus = bus
        self.frames: list[can.Message] = []

    async def until(self, enough: Callable[[can.Message], bool]) -> list[can.Message]:
        """Look on until a frame passes that is enough; what passed since the last look, that one at the end."""
        seen: list[can.Message] = []
        with anyio.fail_after(LONG_ENOUGH_S):
            while True:
                while self.frames:
                    seen.append(self.frames.pop(0))
                    if enough(seen[-1]):
                        return seen
                await anyio.sleep(_LOOK_S)  # a bus tells nobody that a frame is there
                self.frames += self._bus.drain()

    def forget(self) -> None:
        """What passed until now is not looked at."""
        self._bus.drain()
        self.frames.clear()


@contextmanager
def onlooker(bus: str) -> Iterator[Onlooker]:
    """At a bus that exists."""
    end = open_bus(bus)
    try:
        yield Onlooker(end)
    finally:
        end.shutdown()


def is_control(frame: can.Message) -> bool:
    return frame.arbitration_id == CONTROL_ID and not frame.is_error_frame


def drives(frame: can.Message) -> bool:
    """Whether a frame tells the wheels to turn."""
    if not is_control(frame):
        return False
    control = decode_control(frame.data)
    speeds = control.wheel_speeds(ROBOT.motors) if not hasattr(control, "angle_urad") else (0.0, 0.0)
    return speeds != (0.0, 0.0)


def brakes(frame: can.Message) -> bool:
    """Whether a frame tells both wheels to brake."""
    if not is_control(frame):
        return False
    control = decode_control(frame.data)
    return isinstance(control, RawControl) and control.left.brake and control.right.brake


def turns(frame: can.Message) -> bool:
    """Whether a frame says that the wheels turn."""
    return frame.arbitration_id == ENCODER.frame_id and ENCODER.unpack(frame.data) != (0, 0)


def stands(frame: can.Message) -> bool:
    """Whether a frame says that the wheels stand."""
    return frame.arbitration_id == ENCODER.frame_id and ENCODER.unpack(frame.data) == (0, 0)


@contextmanager
def runtime(bus: str, folder: Path, *words: str) -> Iterator[Running]:
    """`kurt2rt run` on a bus, started in a folder; killed at the end."""
    with running("run", "--robot", bus, "--port", "0", "--knowledge", "mine.knowledge", *words, folder=folder) as robot:
        yield robot


@asynccontextmanager
async def teacher_of(robot: Running, folder: Path) -> AsyncIterator[TeacherClient]:
    """This program as the teacher of that one, as soon as it listens."""
    line = await anyio.to_thread.run_sync(robot.wait_for, "teachers are listened to on UDP port")
    async with TeacherClient(folder / "var/devices/local", port=int(line.split()[-1])) as teacher:
        yield teacher


async def state_where(robot: TeacherClient, true: Callable[[State], bool]) -> State:
    """The first picture of which that is true."""
    with anyio.fail_after(LONG_ENOUGH_S):
        async for state in robot.states():
            if true(state):
                return state
    raise AssertionError("the client ended")


class Told(NamedTuple):
    """What the story tells at its end."""

    cycles_to_rest: int
    """Of the controller, from the last CONTROL frame of the killed program until the wheels stood."""
    silence_s: float
    """From the kill to the first CONTROL frame of the program that was started in its place."""


async def teach_kill_and_return(bus: str, folder: Path) -> Told:
    """The robot is taught over the bus and drives; its program is killed; it stands, and its program is back."""
    with running("sim", "--bus", bus, "--start", "1", folder=folder) as sim, onlooker(bus) as seen:
        await anyio.to_thread.run_sync(sim.wait_for, f"is on bus {bus}")
        with runtime(bus, folder) as robot, ExitStack() as supervised:
            async with teacher_of(robot, folder) as we:
                assert (await we.take()).accepted
                stopped = await state_where(we, lambda state: state.teacher == "local")
                assert stopped.stopped_because == _STARTED
                lessons = await _until_it_drives(we)
                await seen.until(turns)
                seen.forget()
                robot.process.kill()
                killed_at_s = time.monotonic()
                robot = supervised.enter_context(runtime(bus, folder))
                silent = await _silence(seen)
                silence_s = time.monotonic() - killed_at_s
            async with teacher_of(robot, folder) as we:
                back = await state_where(we, lambda state: not math.isinf(state.infrared_age_s))
                assert (back.action, back.unsaved, back.stopped_because) == (None, 0, _STARTED)
                assert back.lessons >= lessons  # one that was not acknowledged may be there as well
                assert (await we.lessons())[-1].teacher == "local"
                assert (await we.take()).accepted
                await _until_it_drives(we)
    assert silent[-1] is False
    return Told(max((cycle + 1 for cycle, turned in enumerate(silent) if turned), default=0), silence_s)


async def _until_it_drives(we: TeacherClient) -> int:
    """Say go and answer what it asks until it drives by what it was taught; how many lessons that took.

    Again and again: on a machine that has much to do at the same time the guard may stop it now and then.
    """
    lessons = 0
    with anyio.fail_after(LONG_ENOUGH_S):
        async for state in we.states():
            if state.rla is not None and state.left_m_s > 0.1:
                return lessons
            with suppress(NoAnswerError):
                if state.stopped_because:
                    await we.resume()
                elif state.cause == "unknown":
                    lessons += (await we.answer("forward", of=state.tick)).accepted
    raise AssertionError("the client ended")


async def _silence(seen: Onlooker) -> list[bool]:
    """Wait for CONTROL after a silence that no living program keeps; whether the wheels turned, cycle by cycle."""
    turned: list[bool] = []

    def a_new_one(frame: can.Message) -> bool:
        if is_control(frame):
            if len(turned) > _SILENT_CYCLES:
                return True
            turned.clear()
        elif turns(frame) or stands(frame):
            turned.append(turns(frame))
        return False

    await seen.until(a_new_one)
    return turned
