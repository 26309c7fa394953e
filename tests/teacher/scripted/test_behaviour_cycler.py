"""BehaviourCycler with ticks of 0.1 s."""

from kurt2rt.channel.protocol.state import State
from kurt2rt.teacher.scripted.supervisor import EACH_S, BehaviourCycler
from tests.channel.states import state

TURNS = ("straight_on", "turn_left", "turn_right")
PERIOD_S = 0.1
EACH = round(EACH_S / PERIOD_S)


def at(tick: int, behaviour: str) -> State:
    return state(tick=tick, behaviour=behaviour)


def test_update_starts_with_the_robot_s_behaviour_and_cycles() -> None:
    cycler = BehaviourCycler(TURNS, PERIOD_S)
    wanted = []
    follows = "turn_left"
    for tick in range(1000, 1000 + 4 * EACH, 5):
        if cycler.update(at(tick, follows), stopped=False):
            assert cycler.selected is not None
            wanted.append((tick - 1000, cycler.selected))
            follows = cycler.selected
    assert wanted == [(EACH, "turn_right"), (2 * EACH, "straight_on"), (3 * EACH, "turn_left")]


def test_update_lost_command_is_repeated_each_second() -> None:
    cycler = BehaviourCycler(TURNS, PERIOD_S)
    cycler.update(at(0, "straight_on"), stopped=False)
    told = [tick for tick in range(EACH + 31) if cycler.update(at(tick, "straight_on"), stopped=False)]
    assert told == [EACH, EACH + 10, EACH + 20, EACH + 30]
    assert not cycler.update(at(EACH + 41, "turn_left"), stopped=False)
