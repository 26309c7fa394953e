"""Values after steps and rewards, and shares of RLAs in a reward about a tick."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.settings import ReinforcementSettings, TaughtValues
from kurt2rt.core.reinforcement.td_lambda import EligibilityTrace, TdLambda, make_trace
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.statistics import Statistics
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


ALPHA, GAMMA, V0, TRACE_S = 0.3, 0.9, 0.5, 0.7
WORTHS = TaughtValues(first_value=V0, highest_value=None)
SETTINGS = ReinforcementSettings(alpha=ALPHA, gamma=GAMMA, trace_s=TRACE_S, step_s=0.1, with_teacher=WORTHS)
HALF_EACH = {1: 0.5, 2: 0.25}


def rule() -> TdLambda:
    return TdLambda(SETTINGS, WORTHS, 0.01)


def drive(learner: TdLambda, rla_id: int | None, first: int, last: int) -> None:
    for tick in range(first, last + 1):
        learner.update(rla_id, tick)


def test_td_lambda_signal_is_shared_by_the_trace() -> None:
    learner = rule()
    assert learner.credits_for(-1, HALF_EACH) == (Credit(1, -ALPHA * 0.5), Credit(2, -ALPHA * 0.25))
    assert learner.value(1) == V0
    learner.learn(-1, HALF_EACH)
    assert (learner.value(1), learner.value(2), learner.value(3)) == pytest.approx((0.35, 0.425, V0))


def test_td_lambda_pause_ends_step_and_trace() -> None:
    learner = rule()
    drive(learner, 1, 1, 15)
    drive(learner, 2, 1_000_000, 1_000_020)
    assert learner.value(1) == V0


CAPPED = ReinforcementSettings(alpha=ALPHA, step_s=0.1)
"""Default settings: with a teacher values start at 0, which is also the highest; autonomous ones at 0.5."""


def test_td_lambda_teacher_reward_stops_at_highest() -> None:
    learner = TdLambda(CAPPED, CAPPED.with_teacher, 0.01)
    assert learner.credits_for(1, HALF_EACH) == ()
    learner.learn(-1, {1: 0.2})
    assert learner.credits_for(1, HALF_EACH) == (Credit(1, pytest.approx(0.06)),)  # type: ignore[arg-type]
    learner.learn(1, HALF_EACH)
    assert (learner.value(1), learner.value(2)) == (0.0, 0.0)


def test_td_lambda_step_stops_at_highest() -> None:
    learner = TdLambda(CAPPED, CAPPED.with_teacher, 0.01)
    learner.restore(Statistics(values={1: -0.2, 2: 0.4}))
    for turn in range(20):
        drive(learner, 1 + turn % 2, turn * 10 + 1, turn * 10 + 10)
    assert learner.value(1) <= 0.0
    assert 0.0 < learner.value(2) < 0.4
