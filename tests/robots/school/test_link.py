"""The school robot's link in simulated time: greeting, ages, restarts, foreign commands, the robot's own watchdog."""

import math
import time
from collections import deque

import pytest

from hal.bus import BusError
from hal.byte_port import MemoryPort
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_link import ForeignCommandReport, RangeReport
from kurt2rt.robots.school.lines import encode
from kurt2rt.robots.school.link import SchoolLink
from kurt2rt.robots.school.simulated import SchoolElectronics
from tests.robots.school.rig import FORWARD, SETTINGS, MemoryRig

READINGS = (812, 40, 0, 0, 0, 0, 0)


class FarEnd:
    """The robot's end of a line, written by hand."""

    def __init__(self, *, greets: bool = True) -> None:
        port, self.port = MemoryPort.pair()
        self.link = SchoolLink(port, len(READINGS), first_number=10)
        self.number = -1
        if greets:
            self.link.receive(0.0)
            self.port.read()
            self.write("school", 1, len(READINGS))
            self.link.receive(0.0)

    def write(self, word: str, *numbers: int) -> None:
        self.number += 1
        self.port.write(encode(word, self.number, *numbers))

    def sense(self, time_ms: int, left: int = 0, right: int = 0, command: int = -1) -> None:
        self.write("sense", time_ms, left, right, command, *READINGS)


@pytest.mark.parametrize("greeting", [(2, 7), (1, 5), (1,)])
def test_link_another_version_or_robot_is_refused(greeting: tuple[int, ...]) -> None:
    far = FarEnd(greets=False)
    far.write("school", *greeting)
    with pytest.raises(BusError, match=r"greets with version and sensors .*allowed is \(1, 7\); load a robot file"):
        far.link.receive(0.0)
    assert not far.link.greeted


def test_link_lines_of_a_stall_are_as_old_as_they_are() -> None:
    far = FarEnd()
    for time_ms in range(20, 1020, 20):
        far.sense(time_ms)
        far.link.receive(time_ms / 1000)
    for time_ms in range(1020, 3020, 20):
        far.sense(time_ms)
    ages_s = [3.0 - each.at_s for each in far.link.receive(3.0) if isinstance(each, RangeReport)]
    assert ages_s[0] == pytest.approx(1.98, abs=0.02)
    assert ages_s[-1] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize("numbers", [(20, 0, 0, -1), (20, 0, 0, -1, *READINGS, 1), (20, 0, 0, -1, 1024, *READINGS[1:])])
def test_link_impossible_line_is_junk(numbers: tuple[int, ...]) -> None:
    far = FarEnd()
    far.write("sense", *numbers)
    assert far.link.receive(1.0) == []
    assert far.link.junk == 1


@pytest.mark.parametrize(("late_s", "stops"), [(0.1, False), (0.25, True)])
def test_robot_that_obeys_late_is_stopped_for_good(late_s: float, stops: bool) -> None:
    """Its readings are fresh: only the way of the commands is slow."""
    rig = MemoryRig()
    assert rig.run(1.0).wheel_speeds == FORWARD
    slow: deque[bytes] = deque()
    inward, rig.line.port._outward = rig.line.port._outward, slow
    late: deque[list[bytes]] = deque([[]] * round(late_s / SETTINGS.cycle_s))
    for _ in range(100):
        result = rig.tick()
        late.append(list(slow))
        slow.clear()
        inward.extend(late.popleft())
    assert result.latched is stops
    assert result.reasons == ((GuardReason.BUS_BLOCKED,) if stops else ())


def test_robot_drives_on_after_a_silence_of_its_line() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    ways = rig.line.port._inward, rig.line.port._outward
    rig.line.port._inward, rig.line.port._outward = deque(), deque()
    assert rig.run(0.5).reasons == (GuardReason.INFRARED_STALE,)
    rig.line.port._inward, rig.line.port._outward = ways
    ways[0].clear()
    assert rig.run(1.0).wheel_speeds == FORWARD


def test_link_command_of_another_program_is_reported() -> None:
    far = FarEnd()
    far.link.send(FORWARD)
    far.sense(20, command=11)
    far.sense(40, command=-1)
    assert not [each for each in far.link.receive(1.0) if isinstance(each, ForeignCommandReport)]
    far.sense(60, command=40_000)
    assert [each for each in far.link.receive(1.0) if isinstance(each, ForeignCommandReport)]


@pytest.mark.parametrize("speed_m_s", [0.08, 0.0804, 0.0799999, -0.0804, 0.057, 1e-9, -0.0, 0.1499])
def test_applied_speed_is_whole_and_never_faster(speed_m_s: float) -> None:
    (left_m_s, right_m_s) = FarEnd().link.applied(WheelSpeeds(speed_m_s, -speed_m_s))
    assert left_m_s == -right_m_s
    assert abs(left_m_s) <= abs(speed_m_s)
    assert abs(left_m_s) > abs(speed_m_s) - 0.001
    assert math.isclose(left_m_s * 1000, round(left_m_s * 1000))


def test_robot_without_commands_brakes_by_itself() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    for _ in range(19):
        rig.simulated.step()
    assert not rig.simulated.controller.watchdog_expired
    for _ in range(15):
        rig.simulated.step()
    assert rig.simulated.wheel_speeds == STANDSTILL


def test_robot_lost_line_latches_and_is_opened_again() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    rig.line.port.lost = True
    result = rig.tick()
    assert (result.latched, result.reasons) == (True, (GuardReason.BUS_LOST,))
    rig.run(0.5)
    assert rig.simulated.wheel_speeds == STANDSTILL
    rig.robot.release()
    assert rig.tick().latched
    rig.line.port.lost = False
    rig.run(1.5)
    rig.robot.release()
    assert not rig.run(0.5).latched
    assert rig.simulated.wheel_speeds == pytest.approx(FORWARD, abs=0.001)


def test_robot_does_not_jump_after_its_line_was_opened_again() -> None:
    """A resume right after the opening drove by the lines of before, while the line still waited for the greeting."""
    rig = MemoryRig()
    rig.run(1.0)
    rig.line.port.lost = True
    rig.tick()
    rig.line.port.lost = False
    rig.run(0.98)
    before_m_s = 0.0
    for _ in range(50):
        rig.robot.release()
        rig.tick()
        told_m_s = rig.simulated.controller.commands.left_m_s
        assert told_m_s - before_m_s <= 2 * SETTINGS.guard.acceleration_m_s2 * SETTINGS.cycle_s
        before_m_s = told_m_s
    assert before_m_s == FORWARD.left_m_s


def test_robot_silent_line_makes_its_senses_stale() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    for _ in range(round(SETTINGS.guard.stale_infrared_s / SETTINGS.cycle_s) + 2):
        rig.now_s += SETTINGS.cycle_s
        rig.robot.sense(rig.now_s)
        result = rig.robot.drive(FORWARD, rig.now_s, rig.now_s)
    assert result.reasons == (GuardReason.INFRARED_STALE,)


def test_robot_power_cycle_stops_it_and_the_run_goes_on() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    rig.simulated.controller.power_cycle()
    assert not rig.run(1.0).latched
    assert rig.simulated.wheel_speeds == pytest.approx(FORWARD, abs=0.001)


def test_robot_too_fast_command_is_not_obeyed() -> None:
    rig = MemoryRig()
    rig.run(0.5)
    rig.line.port.write(encode("drive", 1, 2000, 2000))
    rig.simulated.step()
    assert rig.simulated.controller.commands.left_m_s == pytest.approx(0.08)


def test_live_robot_that_misses_cycles_is_not_old() -> None:
    rig = MemoryRig()
    with rig.line.live():
        electronics = rig.simulated.controller
        assert isinstance(electronics, SchoolElectronics)
        assert electronics.clock is time.monotonic
        electronics.clock = lambda: rig.now_s
        rig.run(0.5)
        rig.now_s += 0.3  # the simulation's thread was not run for so long
        rig.run(0.02)
        assert rig.robot.sense(rig.now_s).infrared_age_s < 0.05
