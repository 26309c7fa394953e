"""Which of several behaviours is wanted when, seen in pictures of a robot whose ticks are a tenth of a second."""

from kurt2rt.channel.protocol.state import State
from kurt2rt.teacher.scripted.behaviour_cycler import EACH_S, BehaviourCycler
from tests.channel.states import state

TURNS = ("straight_on", "turn_left", "turn_right")
PERIOD_S = 0.1
EACH = round(EACH_S / PERIOD_S)


def at(tick: int, behaviour: str) -> State:
    return state(tick=tick, behaviour=behaviour)


def test_it_begins_with_what_the_robot_follows_and_goes_round() -> None:
    in_turn = BehaviourCycler(TURNS, PERIOD_S)
    wanted = []
    follows = "turn_left"
    for tick in range(1000, 1000 + 4 * EACH, 5):
        if in_turn.see(at(tick, follows), stopped=False):
            assert in_turn.wanted is not None
            wanted.append((tick - 1000, in_turn.wanted))
            follows = in_turn.wanted
    assert wanted == [(EACH, "turn_right"), (2 * EACH, "straight_on"), (3 * EACH, "turn_left")]


def test_what_was_not_heard_is_told_again_each_second() -> None:
    in_turn = BehaviourCycler(TURNS, PERIOD_S)
    in_turn.see(at(0, "straight_on"), stopped=False)
    told = [tick for tick in range(EACH + 31) if in_turn.see(at(tick, "straight_on"), stopped=False)]
    assert told == [EACH, EACH + 10, EACH + 20, EACH + 30]
    assert not in_turn.see(at(EACH + 41, "turn_left"), stopped=False)


def test_a_robot_that_somebody_stopped_is_told_nothing_and_its_turn_is_not_over_meanwhile() -> None:
    in_turn = BehaviourCycler(TURNS, PERIOD_S)
    in_turn.see(at(0, "straight_on"), stopped=False)
    assert not any(in_turn.see(at(tick, "straight_on"), stopped=True) for tick in range(1, 2 * EACH))
    assert in_turn.wanted == "straight_on"
    told = [tick for tick in range(2 * EACH, 4 * EACH, 5) if in_turn.see(at(tick, "straight_on"), stopped=False)]
    assert told[0] == 3 * EACH


def test_a_task_with_one_behaviour_is_told_nothing() -> None:
    in_turn = BehaviourCycler(("",), PERIOD_S)
    assert not any(in_turn.see(at(tick, ""), stopped=False) for tick in range(0, 3 * EACH, 5))
