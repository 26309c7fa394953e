"""The base in another program, over real zenoh, and foreign command line tools that look at its topics."""

import time
from collections.abc import Iterator
from contextlib import closing, contextmanager

import pytest

from config.settings import SettingsError
from hal.bus import BusError
from hal.guard_reason import GuardReason
from hal.guarded_robot import GuardedRobot
from kurt2rt.robots.turtlebot.kind import TURTLEBOT
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings
from simbridge.links import RobotEnd
from simbridge.realtime import StandaloneRobot
from simbridge.worlds.world_loading import load_world
from tests.robots.turtlebot.rig import FORWARD, SETTINGS
from tests.ros.helpers import free_locator, wait_for

RMW_SETTINGS = SETTINGS.model_copy(update={"ros": SETTINGS.ros.model_copy(update={"naming": "rmw_zenoh"})})


@contextmanager
def base_at(locator: str, settings: TurtlebotSettings = SETTINGS) -> Iterator[StandaloneRobot]:
    """Run a simulated base in real time, which listens at a locator."""
    end = TURTLEBOT.serve(settings, locator)
    world = load_world("turtlebot/a", settings)
    with StandaloneRobot(world, _end(end), 1, cycle_s=settings.cycle_s) as standalone:
        yield standalone


def _end(end: object) -> RobotEnd:
    return end  # type: ignore[return-value]


def drive(robot: GuardedRobot) -> "tuple[bool, tuple[GuardReason, ...], float]":
    """Drive one tick; return whether the robot is latched, the reasons, and the speed that was applied."""
    now_s = time.monotonic()
    robot.sense(now_s)
    result = robot.drive(FORWARD, now_s, now_s)
    time.sleep(0.01)
    return result.latched, result.reasons, result.wheel_speeds.left_m_s


def drive_on(robot: GuardedRobot) -> "tuple[bool, tuple[GuardReason, ...], float]":
    """Drive one tick, and release a stop that a stall of a busy machine may have caused; a lost link stays stopped."""
    robot.release()
    return drive(robot)


@pytest.mark.parametrize("settings", [SETTINGS, RMW_SETTINGS], ids=["bridge", "rmw_zenoh"])
def test_zenoh_base_drives_is_lost_and_found_again(settings: TurtlebotSettings) -> None:
    locator = free_locator()
    with base_at(locator, settings) as base:
        robot = TURTLEBOT.open(settings, locator)
        wait_for(lambda: drive_on(robot)[2] == FORWARD.left_m_s)
        wait_for(lambda: drive_on(robot)[0] or base.robot.wheel_speeds.left_m_s > 0.09)
        assert robot.health.junk == 0
    with closing(robot):
        wait_for(lambda: drive_on(robot)[1] == (GuardReason.BUS_LOST,))
        assert drive(robot)[0]
        assert "no robot is connected" in robot.health.bus_trouble
        with base_at(locator, settings):
            wait_for(lambda: drive_on(robot)[2] == FORWARD.left_m_s)


def test_zenoh_base_brakes_when_the_runtime_dies() -> None:
    locator = free_locator()
    with base_at(locator) as base:
        robot = TURTLEBOT.open(SETTINGS, locator)
        wait_for(lambda: drive_on(robot)[0] or base.robot.wheel_speeds.left_m_s > 0.09)
        robot._close_link()  # as the end of a process does, without a brake
        wait_for(lambda: base.robot.controller.watchdog_expired and base.robot.wheel_speeds.left_m_s == 0.0)


def test_zenoh_nothing_at_the_address_is_one_line() -> None:
    locator = free_locator()
    with pytest.raises(BusError, match=f"zenoh:{locator}: Unable to connect.*; check the address"):
        TURTLEBOT.open(SETTINGS, locator)


def test_zenoh_base_with_a_tap_is_refused() -> None:
    class Silent:
        def on_rx(self, *_: object) -> None: ...

        def on_tx(self, *_: object) -> None: ...

    with pytest.raises(SettingsError, match="no CAN frames"):
        TURTLEBOT.open(SETTINGS, free_locator(), Silent())
