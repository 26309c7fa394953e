"""The moment of a run that is explained if none is named."""

import pytest

from kurt2rt.runs.explain.timeline import Kind, Stretch, Timeline, telling_moment

DRIVES = Stretch(Kind.DRIVES, "forward", "", 0.0, 5.0)
TURNS = Stretch(Kind.DRIVES, "spin_left", "", 5.0, 9.0)
TOUCHES = Stretch(Kind.ASKS, "asks: touches something", "", 9.0, 11.0)
ASKS = Stretch(Kind.ASKS, "asks", "", 11.0, 12.0)
STOPPED = Stretch(Kind.STANDS, "stopped", "", 12.0, 20.0)


@pytest.mark.parametrize(
    ("stretches", "surprised_s", "at_s"),
    [
        ((DRIVES, TURNS, TOUCHES, ASKS, STOPPED), 7.0, 9.0),
        ((DRIVES, TURNS, ASKS, STOPPED), 7.0, 11.0),
        ((DRIVES, TURNS, STOPPED), 3.0, 3.0),
        ((DRIVES, TURNS, STOPPED), None, 5.0),
        ((STOPPED,), None, 12.0),
    ],
    ids=["touch", "question", "surprise", "change of action", "stands"],
)
def test_the_most_telling_moment(stretches: tuple[Stretch, ...], surprised_s: float | None, at_s: float) -> None:
    moment = telling_moment(Timeline(stretches, (), (), 2000, 0, surprised_s=surprised_s))
    assert moment is not None
    assert moment.at_s == at_s


def test_a_run_without_a_tick_has_no_moment() -> None:
    assert telling_moment(Timeline((), (), (), 0, 0)) is None
