"""Shares of RLAs in a reward about a tick."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.td_lambda import EligibilityTrace, make_trace
from tests.core.helpers import situation

TRACE_TICKS = 70.0
D = math.exp(-1 / TRACE_TICKS)


def drives(*rlas: int | None, answers: bool = True, first_tick: int = 1) -> DecisionHistory:
    """One RLA a tick; None: the robot stood."""
    recent = DecisionHistory(1)
    for tick, rla_id in enumerate(rlas, first_tick):
        remember(recent, tick, rla_id, answers=answers)
    return recent


def remember(recent: DecisionHistory, tick: int, rla_id: int | None, *, answers: bool = True) -> None:
    action = None if rla_id is None else "a"
    decision = Decision(STANDSTILL, DecisionCause.RLA, action, rla_id, None, answers and rla_id is not None)
    recent.add(tick, situation(0.0), decision)


def trace(recent: DecisionHistory, tick: int, since: dict[int, int] | None = None) -> EligibilityTrace:
    return make_trace(recent, tick, trace_ticks=TRACE_TICKS, since=since or {})


@given(st.lists(st.sampled_from([None, 1, 2, 3]), min_size=1, max_size=200), st.integers(0, 199))
def test_trace_equals_the_sum_over_ticks(rlas: list[int | None], back: int) -> None:
    tick = max(1, len(rlas) - back)
    expected: dict[int, float] = {}
    for k, rla_id in enumerate(rlas[:tick], 1):
        if rla_id is not None:
            expected[rla_id] = expected.get(rla_id, 0.0) + (1 - D) * D ** (tick - k)
    shares = trace(drives(*rlas), tick)
    assert sum(shares.values()) <= 1.0 + 1e-12
    for rla_id, share in expected.items():
        assert shares.get(rla_id, 0.0) == pytest.approx(share, abs=0.001)
    assert not np.isnan(list(shares.values())).any()
