"""Holds that yield: they change what other holds taught, and no answer."""

from tests.core.test_tick import Corridor
from tests.core.test_tick_holding import DELAY, NOTICED, STEADY, actions, held
from tests.teacher.helpers import teach

ANSWERED_AT = 100
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
