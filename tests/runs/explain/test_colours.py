"""One colour for each action."""

from kurt2rt.runs.explain.colours import colours_of


def test_colours_of_many_actions_repeat() -> None:
    assert len(colours_of(f"thing_{number}" for number in range(40))) == 40
