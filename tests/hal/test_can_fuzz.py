"""Bad frames by ten thousands, through a real bus into a whole runtime and into the simulated controller."""

import gc
import itertools
import math
import sys

import can
import pytest

from hal import sender_watch
from hal.bus import CONTROL_ID, open_bus
from hal.in_process_bus import InProcessBus
from simbridge.controller.microcontroller import CRASH_STEP_M_S, MicroController
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.world_loading import load_world
from tests.hal.fuzz_frames import CONTROL_MODES, FuzzFrames
from tests.hal.fuzzed_robot import FuzzedRobot
from tests.hal.helpers import ROBOT

MOST_BLOCKS_GROWN = 3_000
"""Pieces of memory that a run may hold more at its end than halfway."""

_numbers = itertools.count()


@pytest.fixture(autouse=True)
def _no_sender_watch(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let bad frames come often with the identifiers of the readings, which would stop the robot for good."""
    monkeypatch.setattr(sender_watch, "_AHEAD_S", math.inf)


async def fuzz(kind: str, seed: int, frames: int) -> FuzzedRobot:
    """Drive through so many bad frames; memory must not grow on the second half of the way."""
    with FuzzedRobot(kind, seed) as robot:
        await robot.drive(frames // 2)
        gc.collect()
        blocks = sys.getallocatedblocks()
        await robot.drive(frames - frames // 2)
        gc.collect()
        assert sys.getallocatedblocks() - blocks < MOST_BLOCKS_GROWN
        assert robot.kurt2.health.frames == robot.onlooker.frames
    return robot


@pytest.mark.parametrize(("kind", "seed", "frames"), [("virtual", 4, 8_000), ("shared", 1, 10_000)])
async def test_no_frame_reaches_the_tick_as_an_exception(kind: str, seed: int, frames: int) -> None:
    robot = await fuzz(kind, seed, frames)
    health = robot.kurt2.health
    assert robot.bad_frames >= frames
    assert robot.onlooker.moved > 300
    assert min(health.junk, health.error_frames, health.foreign_control) > 100
    assert set(robot.onlooker.stands_for) >= {"the bus is off", "another node sends CONTROL"}


@pytest.mark.deep
@pytest.mark.parametrize("seed", range(100, 120))
@pytest.mark.parametrize("kind", ["virtual", "shared"])
async def test_no_frame_of_ten_million_raises_in_the_tick(kind: str, seed: int) -> None:
    robot = await fuzz(kind, seed, 250_000)
    assert robot.bad_frames >= 250_000
    assert robot.onlooker.moved > 3000


def is_whole_control(frame: can.Message) -> bool:
    """Return whether the controller can decode a frame."""
    special = frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame
    mode = int.from_bytes(frame.data[:2], "big")
    return frame.arbitration_id == CONTROL_ID and not special and len(frame.data) >= 8 and mode in CONTROL_MODES


def tell_the_controller(seed: int, cycles: int) -> MicroController:
    """Bad frames for the simulated controller; whatever it is told, its motors do what motors can."""
    name = f"control-fuzz-{next(_numbers)}"
    bus, stranger = open_bus(f"virtual:{name}"), InProcessBus(name)
    stranger.set_id_filter(frozenset())
    robot = SimulatedKurt2(ROBOT, load_world("a", ROBOT), bus, seed)
    controller = robot.controller
    frames = FuzzFrames(seed)
    understood = 0
    was_dead = False
    for _ in range(cycles):
        told = [frames.for_control() for _ in range(50)]
        for frame in told:
            stranger.send(frame, 0)
        before = controller.commands
        robot.step()
        stranger.recv(0)
        understood += sum(map(is_whole_control, told))
        assert controller.control_frames == understood
        orders = controller.commands
        assert math.isfinite(orders.left_m_s)
        assert math.isfinite(orders.right_m_s)
        for was_m_s, is_m_s in zip(before[:2], orders[:2], strict=True):
            assert abs(is_m_s) - abs(was_m_s) <= CRASH_STEP_M_S
        assert max(map(abs, robot.wheel_speeds)) <= ROBOT.motors.maximum_speed_m_s
        was_dead = was_dead or controller.crashed
    assert was_dead, "nothing ever made it crash"
    bus.shutdown()
    stranger.shutdown()
    return controller


def test_no_control_frame_breaks_the_simulated_controller() -> None:
    assert tell_the_controller(1, 300).junk_frames > 1000


@pytest.mark.deep
@pytest.mark.parametrize("seed", range(100, 110))
def test_no_control_frame_of_a_million_breaks_the_simulator(seed: int) -> None:
    assert tell_the_controller(seed, 2000).junk_frames > 10_000
