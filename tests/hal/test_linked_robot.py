"""A robot over a RobotLink: its reports become readings, and the guard, the watchdog and the alarms are KURT2's."""

import math

import pytest

from hal.bus import BusError
from hal.bus_state import ControllerState
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from hal.robot_link import (
    AlarmReport,
    BumperReport,
    ForeignCommandReport,
    NoticeReport,
    RangeReport,
    Report,
    WheelReport,
)
from tests.hal.helpers import ROBOT, SENSORS, TICK_S
from tests.hal.linked_scene import SLOW, Scene

LIMITS, FLOOR = ROBOT.guard, ROBOT.infrared.floor_counts


@pytest.fixture
def scene() -> Scene:
    return Scene()


def test_linked_robot_stands_before_the_first_reports(scene: Scene) -> None:
    result = scene.tick(hears=False)
    assert result == GuardResult(STANDSTILL, (GuardReason.INFRARED_STALE,), latched=False)


def test_linked_robot_drives_by_its_reports(scene: Scene) -> None:
    scene.drive()
    assert scene.link.sent[-1] == SLOW
    readings = scene.robot.sense(scene.now_s)
    assert set(readings.infrared_counts) <= {100, 101}
    assert (readings.infrared_age_s, readings.encoder_age_s, readings.bumper_age_s) == (0.0, 0.0, 0.0)
    assert scene.robot.health.frames == 90
    assert scene.robot.health.controller is ControllerState.ACTIVE
    assert scene.robot.health.trouble == ""


def test_set_points_are_told_to_the_resolution_of_the_link(scene: Scene) -> None:
    scene.drive()
    assert scene.tick(WheelSpeeds(0.109, 0.101)).wheel_speeds == WheelSpeeds(0.10, 0.10)


def test_readings_are_as_old_as_the_oldest_sensor(scene: Scene) -> None:
    scene.drive()
    scene.now_s += 0.03
    scene.link.reports = [RangeReport(scene.now_s, 1, (300,))]
    readings = scene.robot.sense(scene.now_s)
    assert readings.infrared_counts[1] == 300
    assert readings.infrared_age_s == pytest.approx(0.03)


def test_report_is_as_old_as_its_own_time_says(scene: Scene) -> None:
    scene.drive()
    scene.now_s += TICK_S
    scene.link.reports = [WheelReport(scene.now_s - 0.05, 1, 2, TICK_S), BumperReport(scene.now_s - 0.07, 0b1)]
    readings = scene.robot.sense(scene.now_s)
    assert readings.encoder_age_s == pytest.approx(0.05)
    assert readings.bumper_age_s == pytest.approx(0.07)
    assert (readings.encoder_left_ticks, readings.encoder_right_ticks, readings.bumpers) == (1, 2, 1)


def test_bumper_that_is_in_no_table_is_left_out(scene: Scene) -> None:
    scene.link.reports = [BumperReport(scene.now_s, 0xFF)]
    assert scene.robot.sense(scene.now_s).bumpers == (1 << len(ROBOT.bumpers)) - 1


@pytest.mark.parametrize(
    "report",
    [
        *(RangeReport(50.0, 0, (1024,)), RangeReport(50.0, 0, (-1,)), RangeReport(50.0, -1, (100,))),
        *(RangeReport(50.0, 0, ()), RangeReport(50.0, len(SENSORS), (100,)), RangeReport(51.0, 0, (100,))),
        *(RangeReport(math.nan, 0, (100,)), WheelReport(50.0, 5, 5, math.nan), WheelReport(50.0, 5, 5, -0.01)),
        *(WheelReport(50.0, 5, 5, math.inf), BumperReport(math.inf, 0b1)),
    ],
)
def test_junk_changes_nothing_and_is_counted(scene: Scene, report: Report) -> None:
    before = scene.robot.sense(scene.now_s)
    scene.link.junk = 3
    scene.link.reports = [report]
    assert scene.robot.sense(scene.now_s) == before
    assert scene.robot.health.junk == 4


def test_lost_link_stops_until_it_is_back_and_released(scene: Scene) -> None:
    scene.drive()
    scene.link.error = BusError("unplugged", where="link of a test", do="plug it in")
    assert scene.tick(hears=False) == GuardResult(STANDSTILL, (GuardReason.BUS_LOST,), latched=True)
    assert scene.robot.health.bus_trouble == "link of a test: unplugged; plug it in"
    scene.robot.release()
    assert scene.tick(hears=False).latched
    for _ in range(150):
        scene.tick(hears=False)
    assert scene.link.reopened == 1
    scene.link.error = None
    for _ in range(100):
        assert scene.tick().latched
    assert scene.link.reopened == 2
    scene.robot.release()
    assert scene.drive().reasons == ()
    assert scene.robot.health.bus_trouble == ""


def test_link_that_fails_only_to_send_stops_the_robot(scene: Scene) -> None:
    scene.drive()
    scene.now_s += TICK_S
    scene.hear()
    scene.robot.sense(scene.now_s)
    scene.link.error = BusError("full", where="link of a test")
    result = scene.robot.drive(SLOW, scene.now_s, scene.now_s)
    assert result == GuardResult(STANDSTILL, (GuardReason.BUS_LOST,), latched=True)
    assert scene.robot.health.send_failures == 2


def test_commands_that_are_not_carried_stop_the_robot(scene: Scene) -> None:
    scene.drive()
    scene.link.unconfirmed = 2
    assert scene.tick().reasons == (GuardReason.BUS_BLOCKED,)
    assert scene.robot.health.bus_trouble == "link of a test: frames are not carried; check the test"
    scene.robot.release()
    assert scene.link.unconfirmed == 0
    assert not scene.tick().latched


def test_foreign_command_stops_the_robot(scene: Scene) -> None:
    scene.drive()
    scene.link.reports = [ForeignCommandReport(scene.now_s)]
    assert scene.tick().reasons == (GuardReason.FOREIGN_CONTROL,)
    assert scene.robot.health.alarm == "link of a test: another program commands the wheels; find and end it"
    assert scene.robot.health.foreign_control == 1


def test_fault_of_the_robot_stops_it_until_over_and_released(scene: Scene) -> None:
    scene.drive()
    scene.link.reports = [AlarmReport(scene.now_s, "motor\nhot " + 300 * "!")]
    assert scene.tick() == GuardResult(STANDSTILL, (GuardReason.ROBOT_FAULT,), latched=True)
    alarm = scene.robot.health.alarm
    assert alarm == f"link of a test: the robot tells a fault: motor hot {190 * '!'}; mend it"
    assert scene.link.sent[-1] == "brake"
    scene.robot.release()
    assert scene.robot.health.latched is GuardReason.ROBOT_FAULT  # before the drive of that tick
    assert scene.tick().reasons == (GuardReason.ROBOT_FAULT,)
    assert scene.robot.health.alarm == alarm
    scene.link.reports = [AlarmReport(scene.now_s, "")]
    assert scene.tick().latched
    scene.robot.release()
    assert scene.drive().reasons == ()
    assert scene.robot.health.alarm == ""


def test_fault_after_another_stop_keeps_the_robot_stopped(scene: Scene) -> None:
    scene.drive()
    scene.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
    scene.link.reports = [AlarmReport(scene.now_s, " ")]
    assert scene.tick().reasons == (GuardReason.PROGRAM_WAITS,)
    scene.robot.release()
    assert scene.tick().reasons == (GuardReason.ROBOT_FAULT,)
    assert "tells a fault: no text; mend it" in scene.robot.health.alarm


def test_touch_within_one_tick_is_a_front_bumper_once(scene: Scene) -> None:
    scene.drive()
    scene.link.reports = [BumperReport(scene.now_s, pressed) for pressed in (0, 0b1, 0)]
    assert scene.tick().reasons == (GuardReason.FRONT_BUMPER,)
    assert scene.tick().reasons == (GuardReason.SLEW_LIMIT,)


def test_fault_within_one_tick_stops_the_robot(scene: Scene) -> None:
    scene.drive()
    scene.link.reports = [AlarmReport(scene.now_s, text) for text in ("motor hot", "fan slow", "")]
    assert scene.tick().reasons == (GuardReason.ROBOT_FAULT,)
    assert scene.robot.health.alarm == "link of a test: the robot tells a fault: motor hot; mend it"
    scene.robot.release()
    assert not scene.tick().latched


def test_wheels_that_do_not_obey_stop_the_robot(scene: Scene) -> None:
    scene.drive()
    results = []
    for _ in range(60):
        scene.speeds = STANDSTILL  # they stand, whatever they are told
        results.append(scene.tick())
    assert results[-1].reasons == (GuardReason.WHEELS_DISOBEY,)
    assert "left wheels were told 0.10 m/s and turn at 0.00" in scene.robot.health.alarm


def test_first_wheel_report_tells_no_speed(scene: Scene) -> None:
    for _ in range(60):
        scene.now_s += TICK_S
        scene.link.reports = [WheelReport(scene.now_s, 10_000, 10_000, 0.0)]
        scene.robot.sense(scene.now_s)
        assert not scene.robot.drive(STANDSTILL, scene.now_s, scene.now_s).latched


def drive_by_equal(scene: Scene, counts: int) -> GuardResult:
    """Drive while the distance sensors repeat themselves, of which one sees something; return what comes of it."""
    scene.drive()
    result = scene.tick()
    for _ in range(round(LIMITS.frozen_infrared_s / TICK_S) + 2):
        scene.now_s += TICK_S
        scene.hear()
        scene.link.reports[-3] = RangeReport(scene.now_s, 0, (counts,))
        scene.link.reports.append(RangeReport(scene.now_s, 1, (FLOOR,) * (len(SENSORS) - 1)))
        scene.robot.sense(scene.now_s)
        result = scene.robot.drive(SLOW, scene.now_s, scene.now_s)
        scene.speeds = result.wheel_speeds
    return result


@pytest.mark.parametrize("above", [1, 30])
def test_readings_that_repeat_themselves_stop_the_robot(scene: Scene, above: int) -> None:
    assert drive_by_equal(scene, FLOOR + above).reasons == (GuardReason.INFRARED_FROZEN,)
    assert "distance sensors of the robot repeated themselves" in scene.robot.health.alarm


def test_readings_with_nothing_in_view_may_repeat_themselves(scene: Scene) -> None:
    assert drive_by_equal(scene, FLOOR) == GuardResult(SLOW, (), latched=False)


def test_close_brakes_and_closes_the_link(scene: Scene) -> None:
    scene.drive()
    scene.robot.close()
    scene.robot.close()
    assert scene.link.sent[-1] == "brake"
    assert scene.link.closed == 2
    assert scene.tick().reasons == (GuardReason.CLOSED,)


def test_closed_robot_opens_a_lost_link_no_more(scene: Scene) -> None:
    scene.link.error = BusError("unplugged")
    scene.tick(hears=False)
    scene.robot.close()
    for _ in range(150):
        scene.tick(hears=False)
    assert scene.link.reopened == 0


def test_watchdog_brakes_over_the_link(scene: Scene) -> None:
    with scene.robot.watchdog:
        scene.drive()
        scene.now_s += 1.0
        scene.hear()
        scene.robot.sense(scene.now_s)
        assert scene.robot.drive(SLOW, scene.now_s, scene.now_s).reasons == (GuardReason.TICKS_CEASED,)
    assert scene.link.sent[-1] == "brake"


def test_notice_of_the_link_is_told_and_stops_nothing(scene: Scene) -> None:
    scene.drive()
    scene.link.reports = [NoticeReport(scene.now_s, "the clock\nwas set")]
    assert scene.tick().wheel_speeds == SLOW
    assert scene.robot.health.trouble == "link of a test: the clock was set"
    scene.link.reports = [NoticeReport(scene.now_s, "")]
    scene.tick()
    assert scene.robot.health.trouble == ""


def test_notice_does_not_hide_the_reason_of_a_stop(scene: Scene) -> None:
    scene.drive()
    scene.link.reports = [NoticeReport(scene.now_s, "late"), AlarmReport(scene.now_s, "too hot")]
    assert scene.tick().latched
    assert "too hot" in scene.robot.health.trouble
