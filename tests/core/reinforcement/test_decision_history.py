"""History of decisions."""

import numpy as np
import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory

SITUATION = Situation(np.zeros(2), history_frozen=False)


def remembered(*ticks: int, capacity: int = 10) -> DecisionHistory:
    """Return a history: in each tick the situation is its number, and RLA 100 + number drives."""
    recent = DecisionHistory(2, capacity)
    for tick in ticks:
        remember(recent, tick)
    return recent


def remember(recent: DecisionHistory, tick: int, behaviour: str = "", *, blind: bool = False) -> None:
    situation = Situation(np.array([tick, -tick], dtype=np.float64), history_frozen=False)
    decision = Decision(STANDSTILL, DecisionCause.RLA, "a", 100 + tick, None, True)
    recent.add(tick, None if blind else situation, decision, behaviour)


def test_history_full_drops_the_oldest() -> None:
    recent = remembered(*range(1, 11))
    assert [recent.contains(tick) for tick in (0, 1, 10, 11)] == [False, True, True, False]
    remember(recent, 11)
    assert [recent.contains(tick) for tick in (1, 2, 11, 12)] == [False, True, True, False]


def test_history_other_tick_of_the_same_row_is_unknown() -> None:
    recent = remembered(23)
    assert not any(recent.contains(tick) for tick in (3, 13, 33, 2**53 - 2**53 % 10 + 3))


def test_history_missed_tick_is_unknown() -> None:
    recent = remembered(1, 2, 5)
    assert [recent.contains(tick) for tick in range(1, 6)] == [True, True, False, False, True]


def test_history_blind_tick_has_no_situation() -> None:
    recent = remembered(1)
    remember(recent, 2, blind=True)
    assert recent.contains(2)
    assert not recent.has_situation(2)
    assert recent.has_situation(1)
    remember(recent, 12)
    assert recent.has_situation(12)


def test_history_default_capacity_is_1000() -> None:
    recent = DecisionHistory(2)
    for tick in range(1, 1002):
        remember(recent, tick)
    assert [recent.contains(tick) for tick in (1, 2, 1001)] == [False, True, True]


def test_history_returns_answering_rla_by_tick() -> None:
    recent = remembered()
    for tick, answers in enumerate((True, False, True), 1):
        decision = Decision(STANDSTILL, DecisionCause.HELD, "a", 100 + tick, None, answers)
        recent.add(tick, SITUATION, decision)
    recent.add(4, SITUATION, Decision(STANDSTILL, DecisionCause.UNKNOWN, None, None, None))
    assert [recent.answering_rla(tick) for tick in (1, 2, 3, 4)] == [101, None, 103, None]
    ticks, rlas = recent.answering_up_to(3)
    assert (ticks.tolist(), rlas.tolist()) == ([1, 2, 3], [101, 0, 103])


def test_history_answering_up_to_skips_missing_ticks() -> None:
    recent = remembered(*range(1, 8), *range(9, 14))
    assert recent.answering_up_to(12)[0].tolist() == [4, 5, 6, 7, 9, 10, 11, 12]
    assert recent.answering_up_to(7)[0].tolist() == [4, 5, 6, 7]
    assert recent.answering_up_to(2)[0].tolist() == []


@pytest.mark.parametrize("number", [0, 5, 9])  # in one piece, and in two
def test_copied_ticks_stay_while_the_history_continues(number: int) -> None:
    recent = remembered(*range(3, 7), *range(8, 13))
    copy = recent.empty_copy(12)
    copy.copy_ticks(recent, 5, 6, number)
    for tick in range(13, 40):
        remember(recent, tick)
    assert not recent.contains(5)
    assert [copy.number_of(tick, number + tick - 5) for tick in (5, 6, 7, 10)] == [number, number + 1, None, number + 5]
    assert copy.situation(number).tolist() == [5, -5]
    assert copy.driving_rla(number) == 105
