"""Which taught behaviour the robot is to follow."""

import pytest

from kurt2rt.core.decision.active_behaviour import ActiveBehaviour

TURNS = ("straight_on", "turn_left", "turn_right")


def test_the_first_is_wanted_until_another_one_is() -> None:
    wanted = ActiveBehaviour(TURNS)
    assert wanted.behaviour == "straight_on"
    wanted.select("turn_right")
    assert wanted.behaviour == "turn_right"


def test_a_task_that_teaches_one_thing_gives_it_no_name() -> None:
    assert (ActiveBehaviour().behaviours, ActiveBehaviour().behaviour) == (("",), "")


@pytest.mark.parametrize(
    ("behaviours", "known"), [(TURNS, "straight_on, turn_left, turn_right"), (("",), "one, without a name")]
)
def test_what_is_not_taught_cannot_be_wanted(behaviours: tuple[str, ...], known: str) -> None:
    wanted = ActiveBehaviour(behaviours)
    with pytest.raises(ValueError, match=f"^there is no taught behaviour 'fly'; this task has: {known}$"):
        wanted.select("fly")
    assert wanted.behaviour == behaviours[0]
