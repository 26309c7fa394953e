"""Link to the base: sectors, encoders, ages, junk, foreign commands, errors of the base, and loss."""

import math
from collections.abc import Iterator
from itertools import repeat

import numpy as np
import pytest

from hal.guard_reason import GuardReason
from hal.odometry import PlanePose
from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_link import AlarmReport, NoticeReport, Report, WheelReport
from kurt2rt.robots.turtlebot.lidar import ScanReadings
from kurt2rt.robots.turtlebot.link import TurtlebotLink
from kurt2rt.robots.turtlebot.simulated import SimulatedClock
from kurt2rt.ros.laser_scan import full_turn_scan
from kurt2rt.ros.messages import (
    DiagnosticArray,
    DiagnosticStatus,
    Header,
    LaserScan,
    Odometry,
    Time,
    TwistStamped,
    decode,
    encode,
)
from kurt2rt.ros.odometry import odometry_message
from kurt2rt.ros.port import LocalTopics
from kurt2rt.ros.topic import topic_of
from tests.robots.turtlebot.rig import FORWARD, SETTINGS, MemoryRig
from tests.ros.examples import TWIST


class Wire:
    """Link whose other end the test plays."""

    def __init__(self) -> None:
        self.topics, self.clock = LocalTopics(SETTINGS.ros), SimulatedClock()
        self.base = self.topics.join()
        self.twists: list[bytes] = []
        self.base.subscribe(topic_of("cmd_vel", TwistStamped), self.twists.append)
        self.link = TurtlebotLink(SETTINGS, self.topics.join(), "topics of a test", self.clock)
        self._scan = self.base.publisher(topic_of("scan", LaserScan))
        self._odom = self.base.publisher(topic_of("odom", Odometry))

    def scan(self, ranges: list[float], *, stamp_s: float | None = None) -> None:
        values = np.array(ranges, dtype=np.float32)
        self._scan.publish(full_turn_scan(values, (0.12, 3.5), 0.2, self.clock.time_s if stamp_s is None else stamp_s))

    def odom(self, pose: PlanePose, stamp_s: float | None = None) -> None:
        self._odom.publish(odometry_message(pose, 0.0, 0.0, self.clock.time_s if stamp_s is None else stamp_s))

    def receive(self) -> list[Report]:
        return list(self.link.receive(self.clock.time_s))


@pytest.fixture
def wire() -> Wire:
    return Wire()


def wheels_of(reports: list[Report]) -> list[WheelReport]:
    return [report for report in reports if isinstance(report, WheelReport)]


def test_topics_whose_stamps_stand_still_are_named(wire: Wire) -> None:
    told = []
    for _ in range(30):
        wire.clock.time_s += 0.1
        wire.scan([0.5] * 360, stamp_s=1.0)
        wire.odom(PlanePose(), 1.0)
        told += [each.text for each in wire.receive() if isinstance(each, NoticeReport)]
    assert told == ["scan: its time stamps repeat, or go to and fro"]


def alarms_while_driving(wire: Wire, scans: Iterator[list[float]], *, way_m: float) -> list[str]:
    """Drive straight on at 0.1 m/s, and return what the link tells of the base."""
    alarms = []
    for number in range(round(way_m / 0.02) + 1):
        wire.clock.time_s += 0.2
        wire.odom(PlanePose(x_m=number * 0.02))
        wire.scan(next(scans))
        alarms += [each.text for each in wire.receive() if isinstance(each, AlarmReport)]
    return alarms


def test_scans_that_stay_equal_over_a_way_are_a_hang(wire: Wire) -> None:
    same = repeat([0.5] * 360)
    assert alarms_while_driving(wire, same, way_m=0.26) == []
    (told,) = alarms_while_driving(wire, same, way_m=0.1)
    assert "the lidar hangs" in told
    assert alarms_while_driving(wire, repeat([0.6] * 360), way_m=0.0) == [""]


def test_lidar_that_hangs_stops_the_robot_and_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = MemoryRig()
    rig.run(1.0)
    hangs = rig.electronics._fresh = ScanReadings([0] * 24, np.full(360, 0.5, np.float32))
    monkeypatch.setattr(rig.electronics, "update_readings", lambda *_: setattr(rig.electronics, "_fresh", hangs))
    result = rig.run(4.0)
    assert (result.reasons, result.wheel_speeds) == ((GuardReason.ROBOT_FAULT,), STANDSTILL)
    assert "the lidar hangs" in rig.robot.health.alarm


@pytest.mark.parametrize("step_s", [-3600.0, -0.3, 0.3, 5.0])
def test_drive_clock_of_the_base_that_is_set_blinds_shortly(monkeypatch: pytest.MonkeyPatch, step_s: float) -> None:
    rig = MemoryRig()
    clock = rig.link._clock
    clock.time_s = 5000.0
    assert rig.run(1.0).wheel_speeds == FORWARD
    monkeypatch.setattr(clock, "wall_s", lambda: clock.time_s + step_s)
    blind = [rig.tick().wheel_speeds != FORWARD for _ in range(250)]
    assert not any(blind[200:])
    assert not rig.robot.health.latched
    assert rig.robot.health.trouble == f"topics in memory: scan: its clock was set by {step_s:+.1f} s"


def test_scan_that_was_delayed_is_as_old_as_its_stamp(wire: Wire) -> None:
    wire.clock.time_s = 50.0
    wire.scan([0.5] * 360, stamp_s=49.6)
    ages = {50.0 - report.at_s for report in wire.receive()}
    assert min(ages) == max(ages) == pytest.approx(0.4)


def test_odometry_repeated_or_without_number_is_junk(wire: Wire) -> None:
    wire.odom(PlanePose(), 10.0)
    wire.odom(PlanePose(x_m=0.1), 10.0)
    wire.odom(PlanePose(x_m=math.nan), 11.0)
    assert len(wheels_of(wire.receive())) == 1
    assert wire.link.junk == 2


def test_applied_speeds_are_never_above_the_given_ones(wire: Wire) -> None:
    values = np.random.default_rng(1).uniform(-0.22, 0.22, (2000, 2)).tolist()
    for left_m_s, right_m_s in values:
        applied = wire.link.applied(WheelSpeeds(left_m_s, right_m_s))
        assert abs(applied.left_m_s) <= abs(left_m_s) + 1e-4
        assert abs(applied.right_m_s) <= abs(right_m_s) + 1e-4
        assert abs(applied.left_m_s - left_m_s) + abs(applied.right_m_s - right_m_s) <= 0.04


def test_side_that_turns_round_does_not_brake_the_other(wire: Wire) -> None:
    """A spin begins with one side that is quicker than the other; the base stuttered between the brake and 0.08 m/s."""
    for right_mm_s in (0.05, *range(0, -80, -1)):
        applied = wire.link.applied(WheelSpeeds(0.08, right_mm_s / 1000))
        assert applied.left_m_s >= 0.06


def test_drive_silent_scans_alone_stop_the_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = MemoryRig()
    assert rig.run(1.0).wheel_speeds == FORWARD
    monkeypatch.setattr(rig.electronics, "update_readings", lambda *_: None)
    result = rig.run(SETTINGS.guard.stale_infrared_s + 0.2)
    assert (result.wheel_speeds, result.reasons) == (STANDSTILL, (GuardReason.INFRARED_STALE,))


def test_drive_foreign_twist_latches_a_stop() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    rig.send("cmd_vel", TwistStamped(Header(Time(1, 0), "base_link"), TWIST))
    result = rig.tick()
    assert result.latched
    assert result.reasons == (GuardReason.FOREIGN_CONTROL,)
    assert "another program commands the wheels" in rig.robot.health.alarm


def test_drive_error_of_the_base_stops_and_names_it() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    errors = DiagnosticArray(Header(Time(1, 0), ""), [DiagnosticStatus(2, "turtlebot3: motors", "too hot", "", [])])
    fine = DiagnosticArray(Header(Time(1, 0), ""), [DiagnosticStatus(0, "turtlebot3: motors", "", "", [])])
    rig.send("diagnostics", errors)
    result = rig.tick()
    assert (result.latched, result.wheel_speeds, result.reasons) == (True, STANDSTILL, (GuardReason.ROBOT_FAULT,))
    told = "the robot tells a fault: turtlebot3: motors: too hot; mend it"
    assert told in rig.robot.health.alarm
    assert (rig.robot.health.receive_failures, rig.robot.health.send_failures) == (0, 0)
    rig.robot.release()
    assert rig.run(1.5).reasons == (GuardReason.ROBOT_FAULT,)
    rig.send("diagnostics", fine)
    assert rig.run(0.1).latched
    assert told in rig.robot.health.alarm  # until a person has seen it
    rig.robot.release()
    assert rig.run(1.0).wheel_speeds == FORWARD


def test_drive_lost_connection_latches_and_the_base_brakes() -> None:
    rig = MemoryRig()
    rig.run(1.0)
    rig.link.topics.connected = False
    result = rig.tick()
    assert (result.latched, result.reasons) == (True, (GuardReason.BUS_LOST,))
    assert "no robot is connected" in rig.robot.health.bus_trouble
    rig.run(SETTINGS.motors.controller_watchdog_s + 0.5)
    assert rig.simulated.controller.watchdog_expired
    assert rig.simulated.wheel_speeds == STANDSTILL
    rig.link.topics.connected = True
    rig.run(1.5)
    rig.robot.release()
    assert rig.run(1.0).wheel_speeds == FORWARD


def test_base_cuts_a_twist_to_its_limits_and_ignores_nan() -> None:
    rig = MemoryRig()
    rig.tick(STANDSTILL)
    fast = TwistStamped(Header(Time(1, 0), ""), decode(encode(TWIST), type(TWIST)))
    fast.twist.linear.x, fast.twist.angular.z = 9.0, 0.0
    rig.send("cmd_vel", fast)
    rig.simulated.step()
    assert rig.simulated.controller.commands[:2] == (0.22, 0.22)
    fast.twist.linear.x = math.nan
    rig.send("cmd_vel", fast)
    rig.simulated.step()
    assert rig.simulated.controller.junk_frames == 1
    rig.simulated.controller.power_cycle()
    assert rig.simulated.controller.watchdog_expired
