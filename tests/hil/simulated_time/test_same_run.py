"""The simulated robot and the runtime, two processes on the kernel's CAN: every run is the same run."""

from collections.abc import Callable
from itertools import pairwise

import pytest

from tests.hil.simulated_time.played import Played
from tests.hil.simulated_time.stage import Story

pytestmark = pytest.mark.boots


def test_repeated_half_minute_drive_is_bit_identical(play: Callable[[Story], Played]) -> None:
    story = Story(30.0, by_command=True)
    first, second = play(story), play(story)

    # What was done is worth comparing: the robot drove, in every tick, and hit nothing.
    assert first.runtime == {"ticks": 2900, "missed": 0, "turns": []}
    assert " 0 collisions, 0 cycles " in first.robot
    told = first.log.told
    assert len(told) == 2901  # the last one brakes
    gaps_us = [after.at_us - before.at_us for before, after in pairwise(told[:-1])]
    assert min(gaps_us) >= 9_990
    assert max(gaps_us) <= 10_010
    assert sum(turned.ticks > 0 for turned in first.log.turned) > 2800

    assert first.candump == second.candump  # each frame, each payload, each of the kernel's stamps
    assert first.robot == second.robot  # which tells the hash of its state
    assert first.runtime == second.runtime
