"""Decisions of a level after an action that finished, or that cannot go on."""

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause
from tests.core.helpers import MINIMUM_TICKS, SmallLevel
from tests.core.rla.helpers import created

A_AT_0 = created(1, (0.0,), "a")
B_AT_8 = created(2, (8.0,), "b")


def test_an_action_that_has_finished_yields_at_once() -> None:
    small = SmallLevel(A_AT_0, B_AT_8)
    small.at(0.0)
    small.actions["a"].finished = True
    decision = small.at(8.0)
    assert (decision.cause, decision.action, decision.rla_id) == (DecisionCause.RLA, "b", 2)


def test_finished_action_is_not_restarted_while_its_rla_wins() -> None:
    small = SmallLevel(A_AT_0, B_AT_8)
    small.at(0.0)
    small.actions["a"].finished = True
    assert [small.at(0.0).action for _ in range(2 * MINIMUM_TICKS)] == ["a"] * 2 * MINIMUM_TICKS
    assert small.actions["a"].starts == 1


def test_lost_action_stands_and_asks_in_a_known_situation() -> None:
    small = SmallLevel(A_AT_0, B_AT_8)
    small.at(0.0)
    small.actions["a"].lost = True
    decision = small.at(1.0)
    assert (decision.wheel_speeds, decision.cause, decision.action) == (STANDSTILL, DecisionCause.UNKNOWN, None)
    assert decision.asking
    assert decision.match is not None
    assert decision.match.known


def test_a_lost_action_that_finds_its_way_goes_on_where_it_was() -> None:
    small = SmallLevel(A_AT_0)
    small.at(0.0)
    small.actions["a"].lost = True
    small.at(0.0)
    small.actions["a"].lost = False
    assert small.at(0.0).wheel_speeds == WheelSpeeds(0.003, 0.003)
    assert small.actions["a"].starts == 1
