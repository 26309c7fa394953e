"""A stall of the computer keeps a robot stopped until Go, but not one that is simulated in the program that stalled."""

import uuid
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from hal.bus import open_bus
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.kurt2_settings import load_kurt2
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.teaching.commands import Watch
from kurt2rt.service.bus_names import SIMULATED
from kurt2rt.service.open_robot import open_robot
from simbridge.robot_simulation import StallTolerantKurt2
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.world_loading import load_world
from tests.core.test_tick import Corridor
from tests.core.test_tick_by_hand import watch
from tests.teacher.helpers import teach

ROBOT = load_kurt2()
TURN = WheelSpeeds(0.1, -0.1)


class Scene:
    """A robot, simulated in steps, and its driver, whose second guard has a clock that the test sets."""

    def __init__(self, driver: type[Kurt2]) -> None:
        spec = f"virtual:{uuid.uuid4()}"
        self.far_end = open_bus(spec)
        self.now_s = 0.0
        self.simulated = SimulatedKurt2(ROBOT, load_world("a"), self.far_end, 1)
        self.robot = driver(ROBOT, open_bus(spec), lambda: self.now_s)

    def tick(self, wanted: WheelSpeeds = TURN) -> GuardResult:
        self.now_s += ROBOT.cycle_s
        self.simulated.step()
        self.robot.sense(self.now_s)
        return self.robot.drive(wanted, self.now_s, self.now_s)

    def stall(self) -> GuardResult:
        """Time goes by without a tick, and then one comes."""
        self.now_s += 0.5
        return self.tick()


@contextmanager
def scene(driver: type[Kurt2]) -> Iterator[Scene]:
    opened = Scene(driver)
    with opened.robot.watchdog:
        yield opened
    opened.robot.close()
    opened.far_end.shutdown()


def test_on_a_bus_a_stall_keeps_the_robot_stopped_until_go() -> None:
    with scene(Kurt2) as robot:
        for _ in range(20):
            robot.tick()
        assert robot.stall() == GuardResult(STANDSTILL, (GuardReason.TICKS_CEASED,), latched=True)
        assert all(robot.tick().latched for _ in range(100))
        robot.robot.release()
        assert not robot.tick().latched


def test_simulated_in_the_program_it_brakes_and_drives_on() -> None:
    with scene(StallTolerantKurt2) as robot:
        for _ in range(20):
            robot.tick()
        assert robot.stall() == GuardResult(STANDSTILL, (GuardReason.TICKS_CEASED,), latched=False)
        assert not any(robot.tick().latched for _ in range(100))
        assert robot.tick().wheel_speeds == TURN


def test_a_stop_that_was_asked_for_outlasts_a_stall() -> None:
    with scene(StallTolerantKurt2) as robot:
        robot.tick()
        robot.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
        assert robot.stall().latched
        assert robot.tick().reasons == (GuardReason.PROGRAM_WAITS,)
        robot.robot.release()
        assert not robot.tick().latched
        robot.now_s += 0.5
        robot.robot.watchdog.check(robot.now_s)
        robot.robot.emergency_stop(GuardReason.SERVICE_ENDS)  # as a signal does while no tick runs
        assert robot.tick().latched
        assert robot.tick().latched


def test_a_stop_that_comes_just_before_the_release_is_not_lifted(monkeypatch: pytest.MonkeyPatch) -> None:
    release = Kurt2.release

    def overtaken(robot: Kurt2) -> None:
        monkeypatch.setattr(Kurt2, "release", release)
        robot.emergency_stop(GuardReason.SERVICE_ENDS)  # from another thread
        release(robot)

    with scene(StallTolerantKurt2) as robot:
        robot.tick()
        monkeypatch.setattr(Kurt2, "release", overtaken)
        assert robot.stall().latched
        assert robot.tick().reasons == (GuardReason.SERVICE_ENDS,)


def test_only_the_robot_in_this_program_tolerates_stalls() -> None:
    with open_robot(ROBOT, SIMULATED, "a", 1) as opened:
        assert type(opened.robot) is StallTolerantKurt2
    with open_robot(ROBOT, f"virtual:{uuid.uuid4()}", "a", 1) as opened:
        assert type(opened.robot) is Kurt2


@pytest.mark.parametrize("tolerates", [True, False])
def test_missed_ticks_count_against_no_lease_in_simulation(tolerates: bool) -> None:
    corridor = Corridor(attended=True, tolerates_stalls=tolerates)
    corridor.run(100, teach("forward", "first"), watch(corridor))
    assert corridor.run(None, watch(corridor)).decision.driving
    seen = corridor.ticks
    corridor.ticks += 200  # the computer stalled for two seconds
    record = corridor.run(None, Watch("Ann", seen))
    assert record.decision.cause is (DecisionCause.RLA if tolerates else DecisionCause.STOPPED)
    causes = [corridor.run().decision.cause for _ in range(24)]
    assert causes[-1] is DecisionCause.STOPPED  # a teacher who stays away is away
