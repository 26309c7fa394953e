"""Obedient wheels are left alone, whatever their motors are like; others are found out."""

import random
import re
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.control import set_point
from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot import STANDSTILL, WheelSpeeds
from hal.wheel_watch import WheelWatch
from simbridge.robot.wheels import Wheels
from tests.examples import examples
from tests.hal.helpers import ROBOT, TICK_S, robot_with

NO_TOLERANCE = robot_with(wheel_error_m_s=0.004, wheel_error_share=0.0, wheel_error_s=0.001)
"""A frame's ticks are whole, which is 2 mm/s."""


def check(watch: WheelWatch, left_ticks: int, right_ticks: int, cycles: int, now_s: float) -> str:
    """Return the line of the watch after ticks of so many of the controller's cycles."""
    return watch.check(left_ticks, right_ticks, cycles * TICK_S, cycles * TICK_S, now_s)


def wheels_like(acceleration: float = 1.0, braking: float = 1.0, loop_time: float = 1.0) -> Wheels:
    """Return the simulated motors with other responses, as fractions of the settings."""
    motors = ROBOT.motors
    changed = motors.model_copy(
        update={
            "acceleration_m_s2": motors.acceleration_m_s2 * acceleration,
            "braking_m_s2": motors.braking_m_s2 * braking,
            "speed_loop_time_s": motors.speed_loop_time_s * loop_time,
        }
    )
    return Wheels(ROBOT.model_copy(update={"motors": changed}))


class Trial:
    """Wheels, their set points, and the watch."""

    def __init__(self, robot: Kurt2Settings = ROBOT, wheels: Wheels | None = None) -> None:
        self.watch = WheelWatch(robot)
        self.wheels = wheels or Wheels(robot)
        self.now_s = 20.0
        self.told = STANDSTILL
        self.obey: Callable[[WheelSpeeds], WheelSpeeds] = lambda told: told
        """What the motors make of what they are told."""
        self.count: Callable[[int, int], tuple[int, int]] = lambda left, right: (left, right)
        """What the encoders make of the wheels' ticks."""
        self.cycle(0.0, 0.0)

    def cycle(self, left_m_s: float, right_m_s: float, *, brake: bool = False, lost: bool = False) -> str:
        """Tell them, let them turn for a cycle, and look."""
        self.told = WheelSpeeds(left_m_s, right_m_s)
        self.watch.set_command(self.told)
        self.wheels.turn(*self.obey(self.told), brake, brake)
        left, right = self.count(*self.wheels.take_ticks())
        self.now_s += TICK_S
        return check(self.watch, *((0, 0, 0) if lost else (left, right, 1)), self.now_s)

    def drive(self, seconds: float, left_m_s: float, right_m_s: float) -> str:
        """Go on so for a while, speeding up as the guard lets it; what the watch said first."""
        said = ""
        for _ in range(round(seconds / TICK_S)):
            said = said or self.cycle(
                *(slewed(m_s, to) for m_s, to in zip(self.told, (left_m_s, right_m_s), strict=True))
            )
        return said

    def found_out_after_s(self, left_m_s: float, right_m_s: float, within_s: float = 3.0) -> float:
        """Return the time in s until detection; infinite without detection."""
        for cycles in range(1, round(within_s / TICK_S) + 1):
            if self.drive(TICK_S, left_m_s, right_m_s):
                return cycles * TICK_S
        return float("inf")


def slewed(m_s: float, to_m_s: float) -> float:
    return 0.0 if to_m_s == 0.0 else m_s + max(-0.015, min(0.015, to_m_s - m_s))


@pytest.fixture
def trial() -> Trial:
    return Trial()


@pytest.fixture
def driving(trial: Trial) -> Trial:
    assert trial.drive(1.5, 0.3, 0.2) == ""
    return trial


# Who obeys


factors = st.floats(0.5, 2.0)
speeds = st.floats(-0.9, 0.9)


@examples(150)
@given(
    st.tuples(factors, factors, factors),
    st.lists(st.tuples(speeds, speeds, st.booleans(), st.integers(1, 60)), max_size=12),
)
def test_motors_half_or_twice_as_quick_are_never_off_the_band(
    quickness: tuple[float, float, float], orders: list[tuple[float, float, bool, int]]
) -> None:
    """Slewed or not, braked or not: no set point needs a tolerance for the motors' speed of response."""
    trial = Trial(NO_TOLERANCE, wheels_like(*quickness))
    for left_m_s, right_m_s, brake, cycles in orders:
        for _ in range(cycles):
            if brake:
                assert trial.cycle(0.0, 0.0, brake=True) == ""
            else:
                assert trial.cycle(left_m_s, right_m_s) == ""


@given(st.lists(st.tuples(speeds, speeds, st.lists(st.integers(1, 10), max_size=8)), max_size=8))
def test_ticks_that_were_missed_are_no_disobedience(orders: list[tuple[float, float, list[int]]]) -> None:
    watch, wheels = WheelWatch(ROBOT), Wheels(ROBOT)
    now_s = 0.0
    for left_m_s, right_m_s, ticks in orders:
        watch.set_command(WheelSpeeds(left_m_s, right_m_s))
        for cycles in ticks:
            counted = []
            for _ in range(cycles):
                wheels.turn(left_m_s, right_m_s)
                counted.append(wheels.take_ticks())
            now_s += cycles * TICK_S
            left, right = (sum(side) for side in zip(*counted, strict=True))
            assert check(watch, left, right, cycles, now_s) == ""


@pytest.mark.parametrize("mode", SpeedMode)
def test_speed_resolution_of_a_mode_is_no_disobedience(trial: Trial, mode: SpeedMode) -> None:
    def said(told: WheelSpeeds) -> WheelSpeeds:
        return set_point(mode, told, ROBOT.motors).wheel_speeds(ROBOT.motors)

    trial.obey = said
    chance = random.Random(4)
    for _ in range(60):
        assert trial.drive(0.4, chance.uniform(-0.6, 0.6), chance.uniform(-0.6, 0.6)) == ""


@pytest.mark.parametrize("share", [0.9, 0.95, 1.05, 1.1])
def test_motors_and_tick_lengths_differ(trial: Trial, share: float) -> None:
    trial.obey = lambda told: WheelSpeeds(told.left_m_s * share, told.right_m_s * share)
    trial.count = lambda left, right: (round(left * 1.04), round(right * 0.96))
    for speed_m_s in (0.6, -0.6, 0.1, -0.3, 0.0):
        assert trial.drive(1.5, speed_m_s, speed_m_s) == ""


def test_lost_encoder_frames_take_their_ticks_along(trial: Trial) -> None:
    chance = random.Random(7)
    for tick in range(3000):
        speed_m_s = 0.3 if tick // 150 % 2 else -0.3
        assert trial.cycle(slewed(trial.told.left_m_s, speed_m_s), 0.0, lost=chance.random() < 0.1) == ""


def test_wheels_stopped_during_a_pause_restart_the_band(driving: Trial) -> None:
    for _ in range(30):
        driving.wheels.turn(0.0, 0.0, True, True)
    driving.wheels.take_ticks()
    driving.now_s += 30 * TICK_S
    assert driving.drive(2.0, 0.3, 0.2) == ""


def test_encoders_that_come_back_find_the_wheels_as_they_are(driving: Trial) -> None:
    """A controller that hung for a second: it goes on at the old speed and has yet to hear that it should stand."""
    for _ in range(100):
        driving.now_s += TICK_S
        driving.watch.set_command(STANDSTILL)
        assert check(driving.watch, 0, 0, 0, driving.now_s) == ""
    driving.told = STANDSTILL
    assert driving.drive(1.0, 0.0, 0.0) == ""


def test_slow_controller_is_judged_by_its_own_cycles(trial: Trial) -> None:
    """A simulation on a busy machine: two of three cycles do not take place."""
    for tick in range(600):
        trial.told = WheelSpeeds(*(slewed(m_s, (-0.3, 0.3)[tick // 100 % 2]) for m_s in trial.told))
        trial.watch.set_command(trial.told)
        trial.now_s += TICK_S
        left = right = frames = 0
        if tick % 3 == 0:
            trial.wheels.turn(*trial.told)
            left, right = trial.wheels.take_ticks()
            frames = 1
        assert check(trial.watch, left, right, frames, trial.now_s) == ""


def test_a_short_silence_is_no_excuse(driving: Trial) -> None:
    driving.obey = lambda _: WheelSpeeds(0.3, 0.3)
    said = ""
    for cycle in range(100):
        said = said or driving.cycle(0.0, 0.0, lost=cycle % 8 != 0)
    assert said


def test_a_clock_that_ran_backwards_starts_anew(driving: Trial) -> None:
    driving.now_s -= 1.0
    driving.wheels.halt()
    assert driving.drive(2.0, 0.3, 0.2) == ""


# Who does not


def test_a_dead_motor(driving: Trial) -> None:
    driving.obey = lambda told: WheelSpeeds(0.0, told.right_m_s)
    assert driving.found_out_after_s(0.3, 0.2) <= 0.4


@pytest.mark.parametrize("runs_at_m_s", [0.3, -0.3, 0.9])
def test_a_motor_that_turns_although_it_is_told_to_stand(trial: Trial, runs_at_m_s: float) -> None:
    trial.obey = lambda _: WheelSpeeds(0.0, runs_at_m_s)
    assert trial.found_out_after_s(0.0, 0.0) <= 0.3


def test_a_motor_at_half_its_speed(driving: Trial) -> None:
    driving.obey = lambda told: WheelSpeeds(told.left_m_s / 2, told.right_m_s)
    assert driving.found_out_after_s(0.3, 0.2) <= 0.6


def test_a_motor_that_turns_the_other_way(driving: Trial) -> None:
    driving.obey = lambda told: WheelSpeeds(-told.left_m_s, told.right_m_s)
    assert driving.found_out_after_s(0.3, 0.2) <= 0.4


def test_sides_that_were_swapped_show_in_the_first_turn(trial: Trial) -> None:
    trial.obey = lambda told: WheelSpeeds(told.right_m_s, told.left_m_s)
    assert trial.drive(2.0, 0.3, 0.3) == ""  # straight ahead not detectable
    assert trial.found_out_after_s(-0.2, 0.2) <= 0.6


@pytest.mark.parametrize("stuck_at", [0, 174, -174, 32767])
def test_an_encoder_that_is_stuck_shows_when_it_should_change(driving: Trial, stuck_at: int) -> None:
    driving.count = lambda left, _: (left, stuck_at)
    assert driving.found_out_after_s(0.0, 0.0) <= (0.3 if stuck_at else float("inf"))
    assert driving.found_out_after_s(0.3, -0.3) <= 0.6


def test_an_encoder_that_counts_garbage(driving: Trial) -> None:
    chance = random.Random(1)
    driving.count = lambda left, _: (left, chance.randint(-32768, 32767))
    assert driving.found_out_after_s(0.3, 0.2) <= 0.25


def test_now_and_then_is_forgiven_but_most_of_the_time_is_not(driving: Trial) -> None:
    cycles = iter(range(1000))
    driving.count = lambda left, right: (left if next(cycles) % 3 else 0, right)  # a third of its frames is wrong
    assert driving.drive(3.0, 0.3, 0.2) == ""
    driving.count = lambda left, right: (0 if next(cycles) % 3 else left, right)
    assert driving.found_out_after_s(0.3, 0.2) <= 0.7


def test_it_says_which_side_does_what_as_long_as_it_does(driving: Trial) -> None:
    driving.count = lambda left, _: (left, -58)
    driving.found_out_after_s(0.3, 0.2)
    assert re.findall("left|right|-?[0-9.]{4}", driving.cycle(0.3, 0.2)) == ["right", "0.20", "-0.10"]
    driving.count = lambda _, right: (0, right)
    driving.drive(1.0, 0.3, 0.2)
    assert re.findall("left|right|-?[0-9.]{4}", driving.cycle(0.3, 0.2)) == ["left", "0.30", "0.00"]
    driving.count = lambda left, right: (left, right)
    assert driving.cycle(0.3, 0.2) == ""
