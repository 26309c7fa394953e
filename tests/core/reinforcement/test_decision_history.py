"""History of decisions."""

import numpy as np

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory


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


def test_history_blind_tick_has_no_situation() -> None:
    recent = remembered(1)
    remember(recent, 2, blind=True)
    assert recent.contains(2)
    assert not recent.has_situation(2)
    assert recent.has_situation(1)
    remember(recent, 12)
    assert recent.has_situation(12)
