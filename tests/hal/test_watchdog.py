"""The second guard notices that ticks have ceased."""

import threading

import pytest

from hal.bus import CanBus
from hal.control import RawControl, RawSide
from hal.guard_reason import GuardReason
from hal.watchdog import Watchdog
from tests.hal.helpers import ROBOT, controls, guard_on

Ends = tuple[CanBus, CanBus]


class VirtualClock:
    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_watchdog_allows_the_silence_from_the_first_beat(ends: Ends) -> None:
    clock = VirtualClock()
    watchdog = Watchdog(guard_on(ROBOT, ends[0]), 0.1, clock)
    assert not watchdog.check(1e9)
    watchdog.beat()
    assert not watchdog.check(100.1 - 1e-9)
    assert watchdog.check(100.1 + 1e-9)
    clock.now_s = 100.09
    watchdog.beat()
    assert not watchdog.check(100.15)
    assert watchdog.check(float("nan"))


def test_the_thread_brakes_again_and_again_while_no_tick_comes(ends: Ends) -> None:
    robot_end, far_end = ends
    guard = guard_on(ROBOT, robot_end)
    clock = VirtualClock()
    looks = threading.Semaphore(0)

    def observed_clock() -> float:
        looks.release()
        return clock()

    with Watchdog(guard, 0.1, observed_clock) as watchdog:
        assert watchdog.running
        _wait_for(looks, 3)
        assert controls(far_end) == []
        watchdog.beat()
        clock.now_s += 0.2
        _wait_for(looks, 5)
    assert not watchdog.running
    assert guard.latched == GuardReason.TICKS_CEASED
    brakes = controls(far_end)
    assert len(brakes) >= 2
    assert set(brakes) == {RawControl(RawSide(0, brake=True), RawSide(0, brake=True))}


def test_the_thread_sleeps_until_ticks_can_have_ceased(ends: Ends) -> None:
    clock = VirtualClock()
    looks = threading.Semaphore(0)

    def observed_clock() -> float:
        looks.release()
        return clock()

    with Watchdog(guard_on(ROBOT, ends[0]), 60.0, observed_clock) as watchdog:
        watchdog.beat()
        _wait_for(looks, 3)  # the beat's own, and two of the look that sees it
        assert not looks.acquire(timeout=0.1)


def test_a_restart_waits_for_a_beat_again(ends: Ends) -> None:
    guard = guard_on(ROBOT, ends[0])
    watchdog = Watchdog(guard, 0.1)
    watchdog.beat()
    watchdog.start()
    assert not watchdog.check(1e12)
    with pytest.raises(RuntimeError, match="runs already"):
        watchdog.start()
    watchdog.stop()
    watchdog.stop()
    assert guard.latched is None


def _wait_for(looks: threading.Semaphore, count: int) -> None:
    for _ in range(count):
        assert looks.acquire(timeout=60)


def test_watchdog_exposes_its_thread_while_running(ends: Ends) -> None:
    watchdog = Watchdog(guard_on(ROBOT, ends[0]), 0.1, VirtualClock())
    assert watchdog.thread is None
    with watchdog:
        assert watchdog.thread in threading.enumerate()
        assert watchdog.running
    assert watchdog.thread is None
