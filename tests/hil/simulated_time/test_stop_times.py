"""Time from a cause to the frame that stops the robot, by the kernel's own stamps."""

from collections.abc import Callable
from itertools import pairwise

import pytest

from hal.guard_reason import GuardReason
from tests.hil.simulated_time.log import Turned
from tests.hil.simulated_time.played import Played
from tests.hil.simulated_time.stage import Story

pytestmark = pytest.mark.boots

Play = Callable[[Story], Played]
CYCLE_US = 10_000
JITTER_US = 100
"""Work takes no time here, but each look at the clock takes a little."""
DRIVES_TICKS = 340
"""Ticks of both sides in a cycle, at the 0.3 m/s of the teacher's policy."""


def slows(turned: Turned) -> bool:
    return turned.ticks < DRIVES_TICKS


@pytest.mark.parametrize("phase_s", [0.0, 0.0025, 0.005, 0.0075])
def test_silent_sensors_stop_within_50_ms_of_missing_reading(play: Play, phase_s: float) -> None:
    played = play(Story(3.0, phase_s=phase_s, infrared_silent_s=2.0))
    (turn,) = played.runtime["turns"]
    assert turn["reasons"] == [GuardReason.INFRARED_STALE]

    log = played.log
    last_us = log.infrared_us[-1]
    before = [told for told in log.told if told.at_us > last_us and not told.stops]
    stop = next(told for told in log.told if told.at_us > last_us and told.stops)
    assert 50_000 < stop.at_us - last_us <= 60_000 + JITTER_US
    assert before[-1].at_us - last_us <= 50_000 + JITTER_US
    assert stop.at_us - (last_us + CYCLE_US) <= 50_000 + JITTER_US


@pytest.mark.parametrize("phase_s", [0.0, 0.005])
def test_hanging_tick_is_stopped_by_second_guard_within_100_ms(play: Play, phase_s: float) -> None:
    played = play(Story(4.0, phase_s=phase_s, tick_hangs=150))
    (turn,) = played.runtime["turns"]
    assert turn["reasons"] == [GuardReason.TICKS_CEASED]

    hangs_from_us = round(1e6 * played.runtime["hangs_from_s"])
    stop, *later = (told for told in played.log.told if told.at_us > hangs_from_us)
    assert stop.brakes
    assert stop.at_us - hangs_from_us <= 100_000 + JITTER_US
    # It brakes on, also when the loop has come back.
    assert all(told.brakes for told in later)
    gaps_us = [after.at_us - before.at_us for before, after in pairwise([stop, *later])]
    assert max(gaps_us) <= CYCLE_US + JITTER_US


@pytest.mark.parametrize("phase_s", [0.0, 0.0075])
def test_killed_runtime_robot_brakes_by_itself_after_200_ms(play: Play, phase_s: float) -> None:
    log = play(Story(3.5, phase_s=phase_s, runtime_killed_s=2.0)).log
    last_us = log.told[-1].at_us
    assert not log.told[-1].stops
    # It counts its own cycles, and takes up to one to see the last frame.
    slower_us = next(turned.at_us - last_us for turned in log.turned if turned.at_us > last_us and slows(turned))
    assert 200_000 <= slower_us <= 200_000 + CYCLE_US + JITTER_US
    standing_us = next(turned.at_us - last_us for turned in log.turned if turned.at_us > last_us and not turned.ticks)
    assert standing_us - slower_us <= 100_000 + JITTER_US  # from 0.3 m/s at 3 m/s^2
    assert all(turned.ticks == 0 for turned in log.turned if turned.at_us >= last_us + standing_us)


def test_suspended_runtime_brakes_first_and_knows_old_frames(play: Play) -> None:
    """SIGSTOP stops the second guard as well; then it goes on, with a socket full of frames of half a second ago."""
    played = play(Story(4.0, runtime_stopped_s=2.0, robot_stopped_s=2.5))
    stopped_us, goes_on_us = played.moments_us["runtime stopped"], played.moments_us["runtime goes on"]
    after = [told for told in played.log.told if told.at_us > stopped_us]
    assert after[0].at_us >= goes_on_us
    assert all(told.brakes for told in after)
    assert any(not turned.ticks for turned in played.log.turned if turned.at_us < goes_on_us)  # it stood long before

    (turn,) = played.runtime["turns"]
    assert turn["infrared_age_s"] >= 0.5


def test_a_runtime_that_was_stopped_for_a_second_says_so(play: Play) -> None:
    played = play(Story(4.0, runtime_stopped_s=2.0))
    assert [turn["reasons"] for turn in played.runtime["turns"]] == [[GuardReason.TICKS_CEASED]]
