"""The small print of a robot over a link, and of the base of all drivers: each limit to the last number."""

import math

import pytest

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, SensorReadings, readings_before_the_first
from hal.robot_link import BumperReport, ForeignCommandReport, RangeReport, Report, WheelReport
from tests.hal.helpers import ROBOT, SENSORS, TICK_S, robot_with
from tests.hal.linked_scene import SLOW, Scene
from tests.patience import PATIENCE_S

EVERYTHING = RangeReport(50.0, 0, (200,) * len(SENSORS))


@pytest.fixture
def scene() -> Scene:
    return Scene()


def sensed(scene: Scene, *reports: Report) -> SensorReadings:
    """Return the readings after these reports."""
    scene.link.reports = list(reports)
    return scene.robot.sense(scene.now_s)


# Before the first report


def test_readings_before_the_first_have_infinite_ages() -> None:
    nothing = SensorReadings(-math.inf, (0, 0, 0), math.inf, 0, 0, math.inf, 0, math.inf)
    assert readings_before_the_first(3) == nothing


def test_drive_before_the_first_sense_stands_without_sensors(scene: Scene) -> None:
    result = scene.robot.drive(SLOW, scene.now_s, scene.now_s)
    assert (result.wheel_speeds, result.reasons) == (STANDSTILL, (GuardReason.INFRARED_STALE,))


def test_sense_before_the_first_report_knows_nothing(scene: Scene) -> None:
    nothing = readings_before_the_first(len(SENSORS))
    assert sensed(scene) == nothing._replace(time_s=scene.now_s)
    assert scene.link.asked_at_s == [scene.now_s]


def test_sensors_without_a_report_read_0(scene: Scene) -> None:
    assert sensed(scene, RangeReport(50.0, 2, (300,))).infrared_counts == (0, 0, 300, *(0,) * (len(SENSORS) - 3))


def test_robot_that_never_drove_has_no_frozen_sensors(scene: Scene) -> None:
    for _ in range(round(2 * ROBOT.guard.frozen_infrared_s / TICK_S)):
        scene.now_s += TICK_S
        sensed(scene, EVERYTHING._replace(at_s=scene.now_s))
    assert scene.robot.health.latched is None


# Reports


def test_all_wheel_reports_of_a_tick_count(scene: Scene) -> None:
    readings = sensed(scene, WheelReport(50.0, 3, 5, TICK_S), WheelReport(50.0, 4, -1, TICK_S))
    assert (readings.encoder_left_ticks, readings.encoder_right_ticks) == (7, 4)


def test_two_wheel_reports_in_a_tick_are_no_double_speed(scene: Scene) -> None:
    scene.drive()
    for _ in range(60):
        for _ in range(2):
            scene.now_s += TICK_S
            scene.hear()
        scene.robot.sense(scene.now_s)
        result = scene.robot.drive(SLOW, scene.now_s, scene.now_s)
        scene.speeds = result.wheel_speeds
        assert result.reasons == ()


def test_first_wheel_report_is_heard_although_it_has_no_time(scene: Scene) -> None:
    readings = sensed(scene, WheelReport(50.0, 3, 5, 0.0))
    assert (readings.encoder_left_ticks, readings.encoder_right_ticks, readings.encoder_age_s) == (3, 5, 0.0)
    assert scene.robot.health.junk == 0


def test_good_reports_are_no_junk(scene: Scene) -> None:
    sensed(scene, EVERYTHING, WheelReport(50.0, 0, 0, TICK_S), BumperReport(50.0, 0), ForeignCommandReport(50.0))
    assert scene.robot.health.junk == 0


def test_all_junk_and_all_foreign_commands_are_counted(scene: Scene) -> None:
    junk = RangeReport(50.0, 0, (1024,))
    sensed(scene, junk, ForeignCommandReport(50.0), junk, ForeignCommandReport(50.0), junk)
    assert (scene.robot.health.junk, scene.robot.health.foreign_control) == (3, 2)


@pytest.mark.parametrize("counts", [0, 1023])
def test_least_and_largest_count_are_readings(scene: Scene, counts: int) -> None:
    readings = sensed(scene, EVERYTHING, RangeReport(50.0, 2, (counts,)))
    assert readings.infrared_counts[2] == counts


def test_report_of_a_moment_later_is_of_now_and_not_junk(scene: Scene) -> None:
    late = EVERYTHING._replace(at_s=50.0 + 0.01)
    assert sensed(scene, late).infrared_age_s == 0.0
    assert sensed(scene, late._replace(at_s=math.nextafter(late.at_s, math.inf))).infrared_age_s == 0.0
    assert scene.robot.health.junk == 1


def test_unchanged_readings_stay_one_tuple(scene: Scene) -> None:
    """A tick makes no tuple of all counts where nothing changed."""
    first = sensed(scene, EVERYTHING).infrared_counts
    scene.now_s += TICK_S
    assert sensed(scene, EVERYTHING._replace(at_s=scene.now_s)).infrared_counts is first


def test_robot_without_bumpers_drives_without_their_reports() -> None:
    scene = Scene(ROBOT.model_copy(update={"bumpers": ()}))
    for _ in range(30):
        scene.now_s += TICK_S
        scene.hear()
        del scene.link.reports[-1]
        assert scene.robot.sense(scene.now_s).bumper_age_s == 0.0
        scene.speeds = scene.robot.drive(SLOW, scene.now_s, scene.now_s).wheel_speeds
    assert scene.speeds == SLOW


# Stops


def test_release_forgets_the_alarm(scene: Scene) -> None:
    sensed(scene, ForeignCommandReport(50.0))
    assert scene.robot.health.alarm != ""
    scene.robot.release()
    assert scene.robot.health.alarm == ""
    scene.robot.emergency_stop(GuardReason.SERVICE_ENDS)
    assert scene.robot.health.trouble == ""


def test_thread_of_the_watchdog_brakes_without_a_tick(scene: Scene) -> None:
    with scene.robot.watchdog:
        scene.drive()
        scene.now_s += 1.0
        assert scene.link.braked.wait(PATIENCE_S)
    assert scene.robot.health.latched is GuardReason.TICKS_CEASED


@pytest.mark.parametrize(("pause_s", "counts"), [(0.125, True), (0.125 + 2**-9, False)])
def test_only_a_pause_longer_than_allowed_is_no_driving(pause_s: float, counts: bool) -> None:
    """Readings that repeat themselves over a pause count as frozen, unless ticks had ceased."""
    scene = Scene(robot_with(ticks_ceased_s=0.125, frozen_infrared_s=0.125))
    scene.drive()
    scene.now_s = 64.0
    for _ in range(2):
        scene.now_s += 2**-7
        scene.hear()
        scene.robot.sense(scene.now_s)
        assert scene.robot.drive(SLOW, scene.now_s, scene.now_s).wheel_speeds != STANDSTILL
    scene.now_s += pause_s
    scene.robot.sense(scene.now_s)
    assert (scene.robot.health.latched is GuardReason.INFRARED_FROZEN) is counts
