"""The basic level: the winner drives, at least for its minimum time, and an unknown situation stops at once."""

import pytest

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.decision.decision import ActiveBehaviour, DecisionCause, UnknownBehaviourError
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.helpers import MINIMUM_TICKS, RADIUS, Counted, SmallLevel, sensed, situation
from tests.core.rla.helpers import created

A_AT_0 = created(1, (0.0,), "a")
B_AT_8 = created(2, (8.0,), "b")


def test_winner_drives_with_distance_and_runner_up() -> None:
    decision = SmallLevel(A_AT_0, B_AT_8).at(3.0)
    assert (decision.cause, decision.action, decision.rla_id) == (DecisionCause.RLA, "a", 1)
    assert decision.wheel_speeds == WheelSpeeds(0.001, 0.001)
    assert decision.driving
    assert decision.match is not None
    assert decision.match.distance == 3.0
    assert decision.match.runner_up is not None
    assert decision.match.runner_up.rla_id == 2


def test_an_action_holds_for_its_minimum_time_and_then_gives_way() -> None:
    small = SmallLevel(A_AT_0, B_AT_8)
    small.at(0.0)
    held = [small.at(8.0) for _ in range(MINIMUM_TICKS - 1)]
    after = small.at(8.0)
    assert [(each.cause, each.action, each.rla_id) for each in held] == [(DecisionCause.HELD, "a", 1)] * (
        MINIMUM_TICKS - 1
    )
    assert {each.match.rla.rla_id for each in held if each.match is not None} == {2}  # who has won is told meanwhile
    assert (after.cause, after.action, after.rla_id) == (DecisionCause.RLA, "b", 2)


def test_unknown_situation_stops_a_held_action_at_once() -> None:
    small = SmallLevel(A_AT_0, B_AT_8)
    small.at(0.0)
    assert small.at(8.0).cause is DecisionCause.HELD
    assert small.at(18.0).driving  # the border itself is known
    decision = small.at(18.000001)
    assert (decision.wheel_speeds, decision.cause, decision.action) == (STANDSTILL, DecisionCause.UNKNOWN, None)
    assert decision.match is not None
    assert decision.match.rla.rla_id == 2


def test_blocking_cause_stands_and_keeps_the_match() -> None:
    cause = DecisionCause.STOPPED
    small = SmallLevel(A_AT_0)
    small.at(0.0)
    decision = small.at(0.0, cause)
    assert (decision.wheel_speeds, decision.cause, decision.action, decision.rla_id) == (STANDSTILL, cause, None, None)
    assert decision.match is not None
    assert decision.match.known
    assert not decision.asking
    assert small.at(0.0).action == "a"
    assert small.actions["a"].starts == 2


TURNS = ("straight_on", "turn_left")
STRAIGHT_AT_0 = created(1, (0.0,), "a", behaviour="straight_on")
LEFT_AT_1 = created(2, (1.0,), "b", behaviour="turn_left")


def test_rlas_of_inactive_behaviours_never_answer() -> None:
    small = SmallLevel(STRAIGHT_AT_0, LEFT_AT_1, behaviours=TURNS)
    decision = small.at(1.0)
    assert (decision.action, decision.rla_id) == ("a", 1)
    assert decision.match is not None
    assert decision.match.runner_up is None
    small.wanted.select("turn_left")
    decision = small.at(0.0)
    assert (decision.action, decision.rla_id) == ("b", 2)


@pytest.mark.parametrize(
    ("events", "behaviours", "problem"),
    [
        ((A_AT_0,), TURNS, "RLA 1 .* straight_on, turn_left;"),
        ((STRAIGHT_AT_0, LEFT_AT_1), ("straight_on",), "RLA 2 .* turn_left, .* straight_on;"),
        ((LEFT_AT_1,), ("",), "RLA 2 .* turn_left, .* without a name;"),
    ],
)
def test_knowledge_of_a_behaviour_that_the_task_lacks_is_refused(
    events: tuple[RlaCreated, ...], behaviours: tuple[str, ...], problem: str
) -> None:
    with pytest.raises(UnknownBehaviourError, match=problem):
        SmallLevel(*events, behaviours=behaviours)


def test_chosen_competitor_drives_else_the_oldest() -> None:
    events = (created(1, (0.0,), "a"), created(2, (0.0,), "b"))
    assert SmallLevel(*events).at(0.0).rla_id == 1
    system = RlaSystem(1, RADIUS)
    system.apply_all(events)
    choice = EpsilonGreedy({1: -0.5, 2: 0.0}.__getitem__, epsilon=0.0, hold_ticks=100, seed=0)
    level = BasicLevel(system, {name: Counted() for name in "abc"}, 5, ActiveBehaviour(), choice)
    decision = level.decide(situation(3.0), sensed(), None)
    assert (decision.action, decision.rla_id, decision.answers) == ("b", 2, True)
    assert decision.match is not None
    assert decision.match.rla.rla_id == 1
