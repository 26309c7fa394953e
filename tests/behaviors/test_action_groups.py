"""Actions that look alike to a person."""

import pytest

from behaviors.action_groups import action_groups


@pytest.mark.parametrize(
    "names",
    [
        ("forward", "bear_left", "bear_right", "flee", "along_left_wall"),
        ("curve_left", "sharp_left"),
        ("spin_right", "whirl_right", "quarter_turn_right"),
    ],
)
def test_action_groups_similar_actions_share_a_group(names: tuple[str, ...]) -> None:
    groups = action_groups("basic")
    assert len({groups[name] for name in names}) == 1


def test_action_groups_different_actions_are_apart() -> None:
    groups = action_groups("basic")
    names = ("forward", "curve_left", "curve_right", "spin_left", "spin_right", "back", "stand")
    assert len({groups[name] for name in names}) == len(names)
