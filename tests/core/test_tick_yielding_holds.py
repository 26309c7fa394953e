"""Holds that yield: they change what other holds taught, and no answer."""

from tests.core.test_tick import Corridor
from tests.core.test_tick_holding import DELAY, NOTICED, STEADY, actions, held, hold, release
from tests.teacher.helpers import correct, teach

ANSWERED_AT = 100
ELSEWHERE = 125
"""Counts that are farther from the answer than the share of R in which a correction replaces."""
LONG = NOTICED + DELAY + 3 * STEADY


def driving(*, yields: bool = True) -> Corridor:
    """Return a robot that was answered at 100 counts, and has driven there for two seconds."""
    corridor = Corridor(answers_override_holds=yields)
    corridor.run(ANSWERED_AT, teach("forward", "answer"))
    for _ in range(200):
        corridor.run(ANSWERED_AT)
    return corridor


def test_hold_leaves_an_answer_as_it_is() -> None:
    corridor = driving()
    held(corridor, LONG, ANSWERED_AT)
    assert actions(corridor) == {1: "forward"}


def test_hold_replaces_an_answer_without_the_setting() -> None:
    corridor = driving(yields=False)
    held(corridor, LONG, ANSWERED_AT)
    assert actions(corridor) == {1: "back"}


def test_correction_by_a_press_changes_an_answer() -> None:
    corridor = driving()
    corridor.run(ANSWERED_AT, correct("back"))
    assert actions(corridor) == {1: "back"}


def test_hold_teaches_elsewhere_and_changes_other_holds() -> None:
    corridor = driving()
    held(corridor, LONG, ELSEWHERE)
    assert actions(corridor) == {1: "forward", 2: "back"}
    corridor.run(ELSEWHERE, release())
    for _ in range(LONG):
        corridor.run(ELSEWHERE)
    for _ in range(LONG):
        corridor.run(ELSEWHERE, hold(corridor, "forward", press=8))
    assert actions(corridor) == {1: "forward", 2: "forward"}
