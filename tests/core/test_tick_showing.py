"""Demonstrations in the tick: what is driven by hand is taught after its teacher has confirmed it."""

import pytest

from hal.robot import WheelSpeeds
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.teaching.commands import Drive, Stop, TeachShown, Undo
from kurt2rt.core.teaching.demonstration import Segment, nearest_action
from kurt2rt.core.teaching.hold_lessons import EVERY_TICKS
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


def taught(corridor: Corridor) -> list[tuple[str, str]]:
    """Return command id and action of the demonstration's lessons."""
    return [
        (event.origin.command_id, event.rla.action)
        for event in corridor.notebook.events
        if isinstance(event, RlaCreated) and "-hold-" in event.origin.command_id
    ]


@pytest.fixture
def shown() -> Corridor:
    """Return a robot that was driven forward at 100 counts, then back at 200 counts."""
    corridor = Corridor()
    drive(corridor, 60, FORWARD, 100)
    drive(corridor, 60, BACK, 200)
    release(corridor)
    return corridor


def test_drive_by_hand_is_published_as_segments_of_actions(shown: Corridor) -> None:
    assert segments(shown) == (Segment("forward", 2, 60), Segment("back", 62, 60))
    assert taught(shown) == []
    assert shown.system.rlas == ()


def test_confirmed_segments_become_lessons(shown: Corridor) -> None:
    result = shown.run(200, TeachShown("show-1", "Ann", 7, (0, 1))).results[0]
    assert result.outcome == Outcome.of(ResultCode.DEMONSTRATION_TAUGHT, segments=2, situations=10, lesson="Ann-hold-7")
    for _ in range(12):
        shown.run(200)
    actions = [action for _, action in taught(shown)]
    assert set(actions) == {"forward", "back"}
    assert len(actions) < 12, "a situation with an agreeing RLA gives no lesson"
    assert all(each.startswith("Ann-hold-7/") for each, _ in taught(shown))


def test_demonstration_is_about_what_the_hand_reacted_to() -> None:
    corridor = Corridor()
    corridor.run(100)
    late = corridor.school.delay.hand_ticks("Ann", 1)
    assert late > EVERY_TICKS
    drive(corridor, 100, FORWARD, 100)
    drive(corridor, late, FORWARD, 200)
    drive(corridor, 100, BACK, 200)
    release(corridor)
    corridor.run(200, TeachShown("show-1", "Ann", 7, (0, 1)))
    for _ in range(30):
        corridor.run(200)
    nearest = {counts: corridor.run(counts).decision.match for counts in (100, 200)}
    assert {counts: match.rla.action for counts, match in nearest.items() if match} == {100: "forward", 200: "back"}
    assert len(taught(corridor)) == 2, "no lesson names forward at 200 counts, where the hand was still late"


def test_only_the_confirmed_segments_are_taught(shown: Corridor) -> None:
    shown.run(200, TeachShown("show-1", "Ann", 7, (1,)))
    for _ in range(12):
        shown.run(200)
    assert {action for _, action in taught(shown)} == {"back"}


def test_undo_takes_a_whole_demonstration_back(shown: Corridor) -> None:
    before = shown.system.knowledge_hash()
    shown.run(200, TeachShown("show-1", "Ann", 7, (0, 1)))
    for _ in range(12):
        shown.run(200)
    result = shown.run(200, Undo("u-1", "Ann", "Ann-hold-7")).results[0]
    assert result.code is ResultCode.HOLD_UNDONE
    assert shown.system.knowledge_hash() == before


def test_undo_ends_the_lessons_that_have_not_been_given(shown: Corridor) -> None:
    shown.run(200, TeachShown("show-1", "Ann", 7, (0, 1)))
    shown.run(200, Undo("u-1", "Ann", "Ann-hold-7"))
    for _ in range(12):
        shown.run(200)
    assert shown.system.rlas == ()


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


@pytest.mark.parametrize(
    ("speeds", "action"),
    [((0.1, 0.1), "forward"), ((-0.5, -0.4), "back"), ((0.3, 0.2), "forward"), ((-0.1, 0.02), "back")],
)
def test_nearest_action_compares_directions(speeds: tuple[float, float], action: str) -> None:
    corridor = Corridor()
    readings = corridor.robot.sense(0.0)
    assert nearest_action(corridor.school.authority.repertoire, readings, WheelSpeeds(*speeds)) == action
