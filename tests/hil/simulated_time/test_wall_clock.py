"""Set wall clock, from which the kernel stamps frames, between a frame and its tick."""

from collections.abc import Callable

import pytest

from hal.guard_reason import GuardReason
from tests.hil.simulated_time.played import Played
from tests.hil.simulated_time.stage import Story

pytestmark = pytest.mark.boots

Play = Callable[[Story], Played]


def test_wall_clock_set_forward_ages_one_cycle_only(play: Play) -> None:
    played = play(Story(3.0, phase_s=0.0075, wall_clock_set_s=2.0, wall_clock_by_s=10.0))
    old, young = played.runtime["turns"]
    assert old["reasons"] == [GuardReason.INFRARED_STALE]
    assert old["infrared_age_s"] > 9.9
    assert young["reasons"] == []
    assert young["tick"] == old["tick"] + 1
    assert not played.log.told[-2].stops


def test_a_clock_that_is_set_back_makes_nothing_younger_than_new(play: Play) -> None:
    played = play(Story(3.0, phase_s=0.0075, wall_clock_set_s=2.0, wall_clock_by_s=-10.0))
    assert played.runtime == {"ticks": 200, "missed": 0, "turns": []}
    assert not played.log.told[-2].stops
