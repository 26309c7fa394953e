"""Simulated robot as a program of its own on a bus."""

import itertools
import threading
from collections.abc import Iterator

import pytest

from hal.bus import BusError, CanBus, open_bus
from hal.codec import SIMULATED_HARDWARE_ID
from hal.frame import Frame
from hal.kurt2 import Kurt2
from hal.robot import WheelSpeeds
from simbridge.links import CanRobotEnd
from simbridge.realtime import StandaloneRobot
from simbridge.worlds.world_loading import load_world
from tests.patience import PATIENCE_S
from tests.simbridge.rig import CODEC, ROBOT

WORLD = load_world("a")

_numbers = itertools.count()


@pytest.fixture
def name() -> str:
    return f"virtual:standalone-test-{next(_numbers)}"


@pytest.fixture
def notebook(name: str) -> Iterator[CanBus]:
    bus = open_bus(name)
    yield bus
    bus.shutdown()


def test_standalone_is_driven_by_a_runtime(name: str, notebook: CanBus) -> None:
    standalone = StandaloneRobot(WORLD, CanRobotEnd(ROBOT, open_bus(name)), seed=1, start=2)
    robot = standalone.robot
    assert robot.pose == WORLD.start_poses[1].pose
    kurt2 = Kurt2(ROBOT, notebook)
    for tick in range(20):  # stepped here, so that the test waits for no clock
        robot.step()
        now_s = tick * ROBOT.cycle_s
        kurt2.sense(now_s)
        kurt2.drive(WheelSpeeds(0.2, 0.2), now_s, now_s)
    assert min(robot.wheel_speeds) > 0.0
    with standalone:
        assert not standalone.simulation.wait(0.0)
    assert standalone.simulation.wait(0.0)
    kurt2.close()


def test_standalone_identifies_as_simulated(name: str, notebook: CanBus) -> None:
    standalone = StandaloneRobot(WORLD, CanRobotEnd(ROBOT, open_bus(name)), seed=1)
    for _ in range(10):
        standalone.robot.step()
    told = {CODEC.by_id[frame.arbitration_id].name: frame.data for frame in notebook.drain()}
    for each in ("INFO_1", "INFO_2"):
        assert CODEC.message(each).unpack(told[each])[0] == SIMULATED_HARDWARE_ID
    with standalone:
        pass


def test_standalone_seed_decides_robot_and_start(name: str) -> None:
    def start_of(seed: int) -> tuple[float, ...]:
        standalone = StandaloneRobot(WORLD, CanRobotEnd(ROBOT, open_bus(f"{name}-{next(_numbers)}")), seed=seed)
        seen = (*standalone.robot.pose, *standalone.robot.infrared_counts)
        with standalone:
            return seen

    assert start_of(1) == start_of(1)
    assert len({start_of(seed) for seed in range(1, 3)}) > 1


def test_standalone_second_robot_is_refused(name: str) -> None:
    with StandaloneRobot(WORLD, CanRobotEnd(ROBOT, open_bus(name)), seed=1) as first:
        stepped = threading.Event()
        end = open_bus(name)
        first.simulation.submit(stepped.set)
        assert stepped.wait(PATIENCE_S)
        with pytest.raises(BusError, match=name):
            StandaloneRobot(WORLD, CanRobotEnd(ROBOT, end), seed=2)
        with pytest.raises(BusError):
            end.drain()


def test_standalone_with_other_senders_starts(name: str, notebook: CanBus) -> None:
    end = open_bus(name)
    notebook.telemetry_port().send(Frame(0x300, bytes(8)))
    Kurt2(ROBOT, notebook).close()  # brakes
    with StandaloneRobot(WORLD, CanRobotEnd(ROBOT, end), seed=1):
        pass
