"""One colour for each action."""

from kurt2rt.runs.explain.colours import colours_of


def test_no_two_actions_look_the_same() -> None:
    for actions in (
        ("bear_right", "along_right_wall", "curve_right", "sharp_right", "spin_right"),
        ("forward", "straight_on", "go_ahead", "slowly_forward"),
        ("bear_left", "bear_left_slowly", "along_left_wall", "turn_left", "quarter_turn_left", "left_again"),
        tuple(f"thing_{number}" for number in range(6)),
    ):
        assert len(set(colours_of(actions).values())) == len(actions)


def test_colours_of_many_actions_repeat() -> None:
    assert len(colours_of(f"thing_{number}" for number in range(40))) == 40
