"""The stack: the mid level's command comes down, and where it does not know the way the robot stands."""

import pytest

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.rla.rla import BASIC, MID
from tests.core.mid_helpers import SmallStack, taught


def test_the_basic_level_does_what_the_mid_level_commands() -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"), taught(5, (1.0, 1.0, 0.0), "turn_right"), radius=0.0)
    decision = small.tick()
    assert (decision.action, decision.rla_id, decision.cause, decision.asks_at) == ("b", 2, DecisionCause.RLA, BASIC)
    assert decision.mid is not None
    assert (decision.mid.behaviour, decision.mid.rla_id) == ("turn_left", 4)


def test_stack_new_command_replaces_held_action_at_once() -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"), taught(5, (1.0, 0.0, 0.0), "turn_right"), radius=0.0)
    assert [small.tick().action, small.tick(1.0).action, small.tick().action] == ["b", "c", "c"]


def test_stack_mid_level_unknown_stands_and_asks_at_mid() -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"), radius=0.0)
    small.tick()
    decision = small.tick(1.0)
    assert (decision.wheel_speeds, decision.cause, decision.action) == (STANDSTILL, DecisionCause.UNKNOWN, None)
    assert decision.asking
    assert decision.asks_at == MID
    assert decision.match is not None
    assert (decision.match.rla.rla_id, decision.match.distance) == (4, 1.0)
    small.system.apply(taught(5, (1.0, 0.0, 0.0), "straight_on"))
    assert (small.tick().action, small.actions["a"].starts) == ("a", 1)


@pytest.mark.parametrize("cause", [DecisionCause.STOPPED, DecisionCause.BLIND, DecisionCause.TEACHER])
def test_stack_blocking_cause_stands_and_still_detects_junctions(cause: DecisionCause) -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"))
    decision = small.tick(1.0, cause)
    assert (decision.wheel_speeds, decision.cause, decision.action) == (STANDSTILL, cause, None)
    assert decision.mid is not None
    assert decision.mid.event is not None
    assert small.tick(1.0, cause).cause is cause  # also where the mid level would ask


def test_stack_faulty_basic_level_stands_while_mid_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    decide = BasicLevel.decide

    def runs_away(level: BasicLevel, *words: object) -> Decision:
        decision = decide(level, *words)  # type: ignore[arg-type]
        return decision._replace(wheel_speeds=WheelSpeeds(5.0, 5.0), cause=DecisionCause.RLA, action="a", rla_id=1)

    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"), radius=0.0)
    small.tick()
    monkeypatch.setattr(BasicLevel, "decide", runs_away)
    decision = small.tick(1.0)
    assert (decision.wheel_speeds, decision.cause, decision.action) == (STANDSTILL, DecisionCause.UNKNOWN, None)
    assert decision.asks_at == MID
