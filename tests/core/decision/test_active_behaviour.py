"""Which taught behaviour the robot is to follow."""

import pytest

from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode

TURNS = ("straight_on", "turn_left", "turn_right")


def test_the_first_is_wanted_until_another_one_is() -> None:
    wanted = ActiveBehaviour(TURNS)
    assert wanted.behaviour == "straight_on"
    wanted.select("turn_right")
    assert wanted.behaviour == "turn_right"


@pytest.mark.parametrize("behaviours", [TURNS, ("",)])
def test_active_behaviour_unknown_name_is_refused(behaviours: tuple[str, ...]) -> None:
    wanted = ActiveBehaviour(behaviours)
    with pytest.raises(CommandRefusedError) as caught:
        wanted.select("fly")
    assert caught.value.outcome == Outcome.of(RefusalCode.NO_BEHAVIOUR, behaviour="fly", known=behaviours)
    assert wanted.behaviour == behaviours[0]
