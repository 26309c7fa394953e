"""Demonstrations in the tick: what is driven by hand is taught after its teacher has confirmed it."""

import pytest

from kurt2rt.core.outcome import RefusalCode, ResultCode
from kurt2rt.core.teaching.commands import Drive, Stop, TeachShown, Undo
from kurt2rt.core.teaching.driven_lessons import Segment
from tests.core.test_tick import Corridor

FORWARD, BACK = (0.2, 0.2), (-0.1, -0.1)


def drive(corridor: Corridor, ticks: int, speeds: tuple[float, float], counts: int, press: int = 7) -> None:
    for _ in range(ticks):
        corridor.run(counts, Drive("Ann", corridor.ticks + 1, press, *speeds))


def release(corridor: Corridor, press: int = 7) -> None:
    corridor.run(None, Stop(f"let go {press}", "Ann", press))
    corridor.run()


def segments(corridor: Corridor) -> tuple[Segment, ...]:
    return corridor.school.demonstration.segments(corridor.ticks)


@pytest.fixture
def shown() -> Corridor:
    """Return a robot that was driven forward at 100 counts, then back at 200 counts."""
    corridor = Corridor()
    drive(corridor, 60, FORWARD, 100)
    drive(corridor, 60, BACK, 200)
    release(corridor)
    return corridor


def test_undo_takes_a_whole_demonstration_back(shown: Corridor) -> None:
    before = shown.system.knowledge_hash()
    shown.run(200, TeachShown("show-1", "Ann", 7, (0, 1)))
    for _ in range(12):
        shown.run(200)
    result = shown.run(200, Undo("u-1", "Ann", "Ann-hold-7")).results[0]
    assert result.code is ResultCode.HOLD_UNDONE
    assert shown.system.knowledge_hash() == before


@pytest.mark.parametrize(
    ("command", "code"),
    [
        (TeachShown("show-1", "Ann", 6, (0,)), RefusalCode.NO_DEMONSTRATION),
        (TeachShown("show-1", "Ann", 7, (2,)), RefusalCode.NO_SEGMENT),
        (TeachShown("show-1", "Ann", 7, (-1,)), RefusalCode.NO_SEGMENT),
        (TeachShown("show-1", "Ann", 7, ()), RefusalCode.NO_SEGMENT),
        (TeachShown("show-1", "Ben", 7, (0,)), RefusalCode.ANOTHER_TEACHES),
    ],
)
def test_confirmation_of_what_was_not_shown_is_refused(shown: Corridor, command: TeachShown, code: RefusalCode) -> None:
    assert shown.run(200, command).results[0].code is code
    assert shown.school.demonstration.press_id == 7


def test_short_wobble_counts_as_the_action_before_it() -> None:
    corridor = Corridor()
    for ticks, speeds in ((10, BACK), (100, FORWARD), (20, BACK), (100, FORWARD)):
        drive(corridor, ticks, speeds, 100)
    release(corridor)
    assert segments(corridor) == (Segment("forward", 2, 230),)
