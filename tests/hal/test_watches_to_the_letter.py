"""The small print of the watches on wheels and boards: their limits to the last number."""

from typing import Any

import pytest

from hal.infrared_frames import board_of
from hal.infrared_watch import InfraredWatch
from hal.kurt2_settings import Kurt2Settings
from hal.robot import WheelSpeeds
from hal.wheel_watch import REVERSAL_SPEED_M_S, WheelWatch
from tests.hal.helpers import robot_with

FINE = 0.0001
"""Speed in m/s of one tick a cycle."""


def measured_finely(metres_per_tick: float = 1e-6, cycle_s: float = 0.01, **limits: Any) -> Kurt2Settings:
    """Shipped robot, watched without tolerance, with encoders of another resolution."""
    least = {"wheel_error_m_s": 0.004, "wheel_error_share": 0.0, "wheel_error_s": 0.001}
    robot = robot_with(**{**least, **limits})
    geometry = robot.geometry.model_copy(update={"metres_per_tick": metres_per_tick})
    return robot.model_copy(update={"geometry": geometry, "cycle_s": cycle_s})


class Watched:
    """Two sides that turn as the test says."""

    def __init__(self, robot: Kurt2Settings, first_ticks: int) -> None:
        self._watch = WheelWatch(robot)
        self._cycle_s = robot.cycle_s
        self.now_s = 8.0
        assert self._watch.check(first_ticks, first_ticks, self._cycle_s, self._cycle_s, self.now_s) == ""

    def turn(self, told_m_s: float, left_ticks: int, right_ticks: int, elapsed_s: float | None = None) -> str:
        self._watch.set_command(WheelSpeeds(told_m_s, told_m_s))
        self.now_s += self._cycle_s if elapsed_s is None else elapsed_s
        return self._watch.check(left_ticks, right_ticks, self._cycle_s, self._cycle_s, self.now_s)


@pytest.mark.parametrize(
    ("from_m_s", "told_m_s", "within_m_s", "off_m_s"),
    [
        (0.3, 0.4, 0.3002, 0.2998),  # the slowest loop makes 0.304 of it
        (0.6, 0.0, 0.5888, 0.5892),  # the slowest brake 0.585
        (0.0, 0.6, 0.0036, 0.0034),  # the slowest motor 0.0075
        (0.01, -0.6, 0.0039, 0.0041),  # it comes to rest before it turns back
    ],
)
def test_band_of_the_slowest_side_is_exact_to_0_1_mm_s(
    from_m_s: float, told_m_s: float, within_m_s: float, off_m_s: float
) -> None:
    first, within, off = (round(speed / FINE) for speed in (from_m_s, within_m_s, off_m_s))
    robot = measured_finely()
    assert Watched(robot, first).turn(told_m_s, within, within) == ""
    assert Watched(robot, first).turn(told_m_s, off, within).startswith("left")
    assert Watched(robot, first).turn(told_m_s, within, off).startswith("right")


def test_a_side_as_slow_as_may_be_is_turned_back_at_once() -> None:
    robot = measured_finely(5e-6)  # 40 of these ticks are 0.02 m/s, to the last bit
    assert REVERSAL_SPEED_M_S == 40 * 5e-6 / 0.01
    assert Watched(robot, 40).turn(-0.3, 22, 22) == ""  # to 0.0072
    assert Watched(robot, 40).turn(-0.3, 23, 22).startswith("left")
    assert Watched(robot, 41).turn(-0.3, 37, 37) == ""  # to 0.0197, for it is told 0 first


EXACT = measured_finely(2**-16, 2**-7, wheel_error_m_s=2**-4, ticks_ceased_s=2**-3)
"""Everything is a power of two, so that a limit can be met exactly: a tick a cycle is 2^-9 m/s."""
HALF = 256
"""Ticks a cycle at 0.5 m/s."""


@pytest.mark.parametrize("ticks", [HALF - 32, HALF + 32])
def test_an_error_as_large_as_is_tolerated_is_tolerated(ticks: int) -> None:
    watched = Watched(EXACT, HALF)
    assert watched.turn(0.5, ticks, ticks) == ""
    further = ticks + (1 if ticks > HALF else -1)
    assert watched.turn(0.5, further, HALF).startswith("left")


def test_band_restarts_only_after_a_pause_longer_than_allowed() -> None:
    for silence_s, said in ((2**-3, "left"), (2**-3 + 2**-7, "")):
        assert Watched(EXACT, HALF).turn(0.5, 0, 0, silence_s)[:4] == said


def test_two_looks_at_the_same_time_forget_nothing() -> None:
    watched = Watched(EXACT, HALF)
    assert watched.turn(0.5, HALF - 33, HALF, 0.0) == ""
    assert watched.turn(0.5, HALF - 33, HALF).startswith("left")


def test_board_is_frozen_exactly_at_the_limit() -> None:
    watch = InfraredWatch(map(board_of, ("ADC00", "BDC00")), 1.0)
    assert watch.check_frozen(50.0, driving=False) == ""
    assert watch.check_frozen(50.5, driving=True) == ""
    watch.board(board_of("BDC00")).still_s = 0.0
    assert watch.check_frozen(51.0 - 2**-20, driving=True) == ""
    assert "ADC*" in watch.check_frozen(51.0, driving=True)
    watch.board(board_of("ADC00")).still_s = 0.0
    assert "BDC*" in watch.check_frozen(51.5, driving=True)


def test_the_time_before_the_first_look_is_no_time_of_repeating() -> None:
    watch = InfraredWatch((board_of("ADC00"),), 1.0)
    assert watch.check_frozen(50.0, driving=True) == ""
    assert watch.check_frozen(50.5, driving=True) == ""
    assert watch.check_frozen(51.0, driving=True) != ""
