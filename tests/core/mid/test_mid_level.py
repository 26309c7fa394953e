"""Commands of the mid level."""

import pytest

from kurt2rt.core.decision.decision import UnknownBehaviourError
from tests.core.mid_helpers import BEHAVIOURS, STRAIGHT, SmallStack, taught
from tests.core.rla.helpers import created


def test_mid_level_nearest_rla_commands() -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"), taught(5, (2.0, 1.0, 1.0), "turn_right"))
    assert (small.commanded().behaviour, small.wanted.behaviour) == ("turn_left", "turn_left")
    small.commanded(1.0)
    small.commanded(1.0)
    third = small.commanded(3.0)
    assert (third.behaviour, third.rla_id, third.asks, third.event) == ("turn_right", 5, False, STRAIGHT)
    assert third.match is not None
    assert (third.match.distance, third.match.radius) == (1.0, 1.0)


def test_mid_level_reports_a_junction_once() -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"))
    assert [small.commanded(symbol).event for symbol in (None, 1.0, None)] == [None, STRAIGHT, None]


def test_mid_level_override_lasts_to_next_junction() -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"))
    small.commanded()
    small.mid.override("turn_right")
    overridden = [small.commanded() for _ in range(3)]
    assert all((each.behaviour, each.overridden, each.rla_id) == ("turn_right", True, None) for each in overridden)
    assert small.wanted.behaviour == "turn_right"
    passed = small.commanded(1.0)
    assert (passed.behaviour, passed.overridden, passed.event) == ("turn_left", False, STRAIGHT)
    assert small.wanted.behaviour == "turn_left"


def test_mid_level_restart_forgets_the_situation() -> None:
    small = SmallStack(taught(4, (0.0, 0.0, 0.0), "turn_left"), taught(5, (1.0, 1.0, 0.0), "turn_right"), radius=0.0)
    small.commanded(1.0)
    assert small.commanded(1.0).behaviour == "turn_right"
    small.stack.restart()
    assert small.commanded().behaviour == "turn_left"


def test_mid_level_unknown_behaviour_in_rla_is_refused() -> None:
    with pytest.raises(UnknownBehaviourError, match=r"RLA 4 .*\bdance\b"):
        SmallStack(taught(4, (0.0, 0.0, 0.0), "dance"))
    assert len(SmallStack(created(4, (5.0,), "a", behaviour=BEHAVIOURS[0])).system.rlas) == 4
