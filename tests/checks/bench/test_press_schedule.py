"""Presses and what the wheels made of them, with times that are known; and a robot that is only looked at."""

from itertools import islice

import pytest

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.checks.bench.press_schedule import ObservedRobot, PressStart, PressTime, press_schedules, waits_ns
from kurt2rt.checks.bench.press_to_wheel import press_result


def test_a_press_waits_until_the_wheels_start_in_its_direction() -> None:
    presses = [PressTime(1000, True), PressTime(2000, False)]
    assert waits_ns(presses, [PressStart(1007, True), PressStart(2009, False)]) == [7, 9]


def test_a_press_that_the_next_one_overtook_is_lost() -> None:
    presses = [PressTime(1000, True), PressTime(2000, False), PressTime(3000, True)]
    assert waits_ns(presses, [PressStart(900, True), PressStart(2500, True), PressStart(3004, True)]) == [4]


def test_presses_keep_no_step_with_the_loop() -> None:
    some = list(islice(press_schedules(1), 100))
    assert all(0.1 <= each.held_s <= 0.15 and 0.25 <= each.next_s <= 0.4 for each in some)
    assert len({round(each.next_s / 0.001) % 10 for each in some}) == 10
    assert some == list(islice(press_schedules(1), 100))


class GrantingRobot:
    """Grants what it is asked for."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def sense(self, now_s: float) -> SensorReadings:
        return SensorReadings(now_s, (), 0.0, 0, 0, 0.0, 0, 0.0)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:  # noqa: ARG002
        return GuardResult(wanted, (), latched=False)

    def emergency_stop(self, reason: GuardReason) -> None:
        self.told.append(reason)

    def release(self) -> None:
        self.told.append("release")

    def close(self) -> None:
        self.told.append("close")


class StandingClock:
    """Always the same moment."""

    def now_s(self) -> float:
        return 5.0

    async def wait_until(self, deadline_s: float) -> None:
        raise AssertionError(deadline_s)


def test_each_start_of_the_wheels_is_noted_once() -> None:
    robot = GrantingRobot()
    observer = ObservedRobot(robot, StandingClock())
    forward, backward = WheelSpeeds(0.02, 0.02), WheelSpeeds(-0.02, -0.02)
    for speeds in (STANDSTILL, forward, WheelSpeeds(0.05, 0.05), STANDSTILL, backward, STANDSTILL):
        assert observer.drive(speeds, 5.0, 5.0).wheel_speeds == speeds
    assert observer.starts == [PressStart(5_000_000_000, True), PressStart(5_000_000_000, False)]
    assert observer.sense(6.0) == robot.sense(6.0)
    observer.emergency_stop(GuardReason.SERVICE_ENDS)
    observer.release()
    observer.close()
    assert robot.told == [GuardReason.SERVICE_ENDS, "release", "close"]


def test_press_result_lost_press_misses_the_goal() -> None:
    result = press_result("press", [6_000_000, 8_000_000], lost=1, period_s=0.01)
    assert [goal.met for goal in result.goals] == [True, True, False]
    assert result.goals[-1].measured == 1
    assert result.took.median_us == pytest.approx(7000.0)
    assert result.reference is not None
    assert result.reference.ratio == pytest.approx(10 / 7)
