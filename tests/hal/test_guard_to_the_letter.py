"""The guard's small print: what the stories do not come by, and what a changed sign or number would break."""

import math
import threading

import can
import pytest

from hal.bus import CanBus
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from hal.watchdog import Watchdog
from tests.hal.helpers import ROBOT, fresh, guard_on
from tests.hal.playing import SlowBus
from tests.hal.test_guard import FRONT, Driver

Ends = tuple[CanBus, CanBus]


@pytest.fixture
def driver(ends: Ends) -> Driver:
    return Driver(ends)


@pytest.mark.parametrize("age_s", [-0.5, -1e-6, -math.inf])
@pytest.mark.parametrize("kind", range(3))
def test_frames_from_after_the_readings_are_no_proof(driver: Driver, kind: int, age_s: float) -> None:
    ages_s = [age_s if at == kind else 0.0 for at in range(3)]
    reason = (GuardReason.INFRARED_STALE, GuardReason.ENCODER_STALE, GuardReason.BUMPER_STALE)[kind]
    readings = fresh(driver.now_s, 0, *ages_s)
    assert driver.tell(WheelSpeeds(0.3, 0.3), readings) == GuardResult(STANDSTILL, (reason,), latched=False)


def test_each_reason_is_told_beside_the_others(driver: Driver) -> None:
    driver.drive(0.0, 0.0)
    assert driver.drive(0.9, -0.9, FRONT).reasons == (
        GuardReason.SPEED_LIMIT,
        GuardReason.FRONT_BUMPER,
        GuardReason.SLEW_LIMIT,
    )


def test_short_stop_before_the_next_tick_starts_from_zero(driver: Driver) -> None:
    driver.drive_for(1.0, 0.5, -0.5)
    driver.guard.emergency_stop(GuardReason.SERVICE_ENDS)
    driver.guard.release()
    assert driver.drive(0.5, -0.5).wheel_speeds == (0.01, -0.01)


def test_bus_trouble_is_empty_before_failure_and_after_release(driver: Driver, ends: Ends) -> None:
    assert driver.guard.bus_trouble == ""
    ends[0].shutdown()
    driver.drive(0.1, 0.1)
    assert driver.guard.bus_trouble != ""
    driver.guard.release()
    assert driver.guard.bus_trouble == ""


class RefusesOne(SlowBus):
    """A bus whose queue was full for one frame."""

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        self.refuses = not self.attempts
        super().send(msg, timeout)


def test_refused_frame_is_reported_though_its_brake_was_sent() -> None:
    end = RefusesOne(receives_own_frames=False)
    guard = guard_on(ROBOT, CanBus("slow", lambda _: end))
    assert guard.drive(WheelSpeeds(0.1, 0.1), fresh(1.0), 1.0, 1.0).reasons == (GuardReason.BUS_LOST,)
    assert guard.send_failures == 1
    assert "sending failed" in guard.bus_trouble


def test_a_frame_is_made_only_when_it_says_something_new() -> None:
    end = SlowBus(receives_own_frames=False)
    guard = guard_on(ROBOT, CanBus("slow", lambda _: end))
    for tick, speeds in enumerate([(0.01, 0.0), (0.01, 0.0), (0.01, 0.01), (0.01, 0.01), (0.0, 0.01)]):
        guard.drive(WheelSpeeds(*speeds), fresh(tick * 0.01), tick * 0.01, tick * 0.01)
    first, second, third, fourth, fifth = end.attempts
    assert first is second is not third
    assert third is fourth is not fifth


def test_the_silence_that_is_allowed_is_allowed_to_its_end(ends: Ends) -> None:
    watchdog = Watchdog(guard_on(ROBOT, ends[0]), 0.125, lambda: 100.0)
    watchdog.beat()
    assert not watchdog.check(100.125)
    assert watchdog.check(100.125 + 1e-9)


def test_watchdog_thread_has_a_name_and_is_a_daemon(ends: Ends) -> None:
    with Watchdog(guard_on(ROBOT, ends[0]), 0.1) as watchdog:
        (thread,) = [thread for thread in threading.enumerate() if thread.name == "watchdog"]
        assert thread.daemon
        with pytest.raises(RuntimeError, match=r"^the watchdog"):
            watchdog.start()
    assert not thread.is_alive()
