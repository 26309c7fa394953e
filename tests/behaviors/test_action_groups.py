"""Actions that look alike to a person."""

from behaviors.action_groups import action_groups


def test_action_groups_different_actions_are_apart() -> None:
    groups = action_groups("basic")
    names = ("forward", "curve_left", "curve_right", "spin_left", "spin_right", "back", "stand")
    assert len({groups[name] for name in names}) == len(names)
