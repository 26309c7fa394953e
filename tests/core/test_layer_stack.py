"""The stack: the mid level's command comes down, and where it does not know the way the robot stands."""

import pytest

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import MID
from tests.core.helpers import runs_away
from tests.core.mid_helpers import SmallStack, taught


def test_stack_faulty_basic_level_stands_while_mid_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"), radius=0.0)
    small.tick()
    runs_away(monkeypatch, wheel_speeds=WheelSpeeds(5.0, 5.0), cause=DecisionCause.RLA, action="a", rla_id=1)
    decision = small.tick(1.0)
    assert (decision.wheel_speeds, decision.cause, decision.action) == (STANDSTILL, DecisionCause.UNKNOWN, None)
    assert decision.asks_at == MID
