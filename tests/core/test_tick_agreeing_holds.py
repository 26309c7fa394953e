"""Holds that agree with the RLAs: they add one where the task says so, and none close to another."""

import pytest

from tests.core.test_tick import Corridor
from tests.core.test_tick_holding import DELAY, NOTICED, STEADY, actions, hold
from tests.teacher.helpers import teach

ANSWERED_AT = 100
ELSEWHERE = 125
LONG = NOTICED + DELAY + 6 * STEADY


@pytest.mark.parametrize(
    ("share", "known"),
    [(1.0, {1: "forward"}), (0.3, {1: "forward", 2: "forward"})],
    ids=["never", "beyond a share"],
)
def test_agreeing_hold_adds_one_rla_far_from_others(share: float, known: dict[int, str]) -> None:
    corridor = Corridor(holds_add_beyond_share=share)
    corridor.run(ANSWERED_AT, teach("forward", "answer"))
    for _ in range(200):
        corridor.run(ELSEWHERE)
    for _ in range(LONG):
        corridor.run(ELSEWHERE, hold(corridor, "forward"))
    assert actions(corridor) == known


def test_agreeing_hold_close_to_an_rla_adds_none() -> None:
    corridor = Corridor(holds_add_beyond_share=0.3)
    corridor.run(ANSWERED_AT, teach("forward", "answer"))
    for _ in range(200):
        corridor.run(ANSWERED_AT)
    for _ in range(LONG):
        corridor.run(ANSWERED_AT, hold(corridor, "forward"))
    assert actions(corridor) == {1: "forward"}
