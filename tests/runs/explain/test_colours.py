"""One colour for each action."""

from itertools import permutations

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


def test_the_order_in_which_they_come_does_not_matter() -> None:
    actions = ("along_right_wall", "bear_right", "forward", "spin_left")
    assert len({tuple(sorted(colours_of(each).items())) for each in permutations(actions)}) == 1
