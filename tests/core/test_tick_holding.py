"""Held actions in the tick: they drive while they are held, and teach what the robot would not have done."""

import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.events import ActionReplaced, LessonUndone, RlaCreated
from kurt2rt.core.teaching.commands import Correct, Drive, HoldAction, Stop, Teach, Undo, Watch
from kurt2rt.core.tick_record import TickRecord
from tests.core.test_tick import Corridor
from tests.teacher.helpers import resume, teach

LEASE = 24
DELAY = 25
"""Delay of the hand, in ticks, if the teacher has given no answers."""
NOTICED = 75
"""Ticks from the moment in which such a teacher notices a mistake to the press."""
STEADY = 10
"""Ticks for which the held action is the same before and after the reaction that a lesson is about."""


def hold(corridor: Corridor, action: str = "back", press: int = 7, *, teacher: str = "Ann", age: int = 0) -> HoldAction:
    """One message of a hold that arrives in the next tick, on the state of `age` ticks before that."""
    return HoldAction(teacher, corridor.ticks + 1 - age, press, action)


def held(corridor: Corridor, ticks: int, counts: int | None = None, action: str = "back") -> list[TickRecord]:
    """Hold an action for so many ticks, with a message in each."""
    return [corridor.run(counts, hold(corridor, action)) for _ in range(ticks)]


def release(press: int = 7, command_id: str = "let go", teacher: str = "Ann") -> Stop:
    return Stop(command_id, teacher, press)


def events(corridor: Corridor) -> list[tuple[str, int]]:
    """Return the hold's lessons: command id, and the RLA's id."""
    return [
        (event.origin.command_id, event.rla.rla_id if isinstance(event, RlaCreated) else event.rla_id)
        for event in corridor.notebook.events
        if isinstance(event, RlaCreated | ActionReplaced) and "-hold-" in event.origin.command_id
    ]


def actions(corridor: Corridor) -> dict[int, str]:
    return {rla.rla_id: rla.action for rla in corridor.system.rlas}


def test_held_action_drives_and_release_hands_back_to_rlas(driving: Corridor) -> None:
    record = driving.run(100, hold(driving))
    assert (record.decision.cause, record.decision.action, record.decision.rla_id) == (
        DecisionCause.TEACHER,
        "back",
        None,
    )
    record = driving.run(130, release())
    assert record.results[0].outcome == Outcome.of(ResultCode.HOLD_RELEASED, lessons=1, lesson="Ann-hold-7")
    assert (record.decision.cause, driving.school.stops.active) == (DecisionCause.RLA, None)


def test_hold_without_messages_ends_after_its_lease(driving: Corridor) -> None:
    driving.run(100, hold(driving))
    causes = [driving.run(100).decision.cause for _ in range(LEASE)]
    assert causes == [DecisionCause.TEACHER] * (LEASE - 1) + [DecisionCause.RLA]
    refused = driving.school.control.follow(hold(driving), driving.ticks)
    assert refused == Outcome(RefusalCode.PRESS_OVER)


def test_absent_teacher_of_a_hold_leaves_a_stopped_robot() -> None:
    corridor = Corridor(attended=True)
    corridor.run(100, teach("forward", "first"), Watch("Ann", 1))
    corridor.run(100, hold(corridor))
    causes = [corridor.run(100).decision.cause for _ in range(LEASE)]
    assert causes == [DecisionCause.TEACHER] * (LEASE - 1) + [DecisionCause.STOPPED]
    corridor.run(100, Watch("Ann", corridor.ticks))
    refused = corridor.school.control.follow(hold(corridor, press=8), corridor.ticks)
    assert refused == Outcome(RefusalCode.ROBOT_STOPPED)


@pytest.mark.parametrize("by", ["Ann", "Ben"])
def test_stop_of_any_teacher_ends_the_hold(driving: Corridor, by: str) -> None:
    driving.run(100, hold(driving))
    record = driving.run(100, hold(driving), Stop("s", by), hold(driving))
    assert (record.decision.cause, record.guard_result.wheel_speeds) == (DecisionCause.STOPPED, STANDSTILL)
    assert driving.run(100, hold(driving, press=8)).decision.cause is DecisionCause.STOPPED
    driving.run(100, resume())
    assert driving.run(100, hold(driving)).decision.cause is DecisionCause.RLA
    assert driving.run(100, hold(driving, press=9)).decision.cause is DecisionCause.TEACHER


def test_late_release_of_an_ended_hold_stops_nothing(driving: Corridor) -> None:
    driving.run(100, hold(driving))
    driving.run(100, release())
    driving.run(100, hold(driving, press=8))
    assert driving.run(100, release(7, "again")).results[0].code is ResultCode.RELEASE_SUPERSEDED
    driving.run(100, release(8, "second"))
    record = driving.run(100, release(7, "late"))
    assert (record.results[0].code, record.decision.cause) == (ResultCode.HOLD_RELEASED, DecisionCause.RLA)


def test_release_of_an_unknown_press_stops_the_robot(driving: Corridor) -> None:
    assert driving.run(100, release(3)).decision.cause is DecisionCause.STOPPED


def test_manual_drive_after_a_hold_stops_on_release(driving: Corridor) -> None:
    driving.run(100, hold(driving))
    driving.run(100, Drive("Ann", driving.ticks, 7, 0.1, 0.1))
    assert driving.run(100, release()).results[0].code is ResultCode.STOPPED


def test_hold_of_an_unknown_action_is_refused(driving: Corridor) -> None:
    refused = driving.school.control.follow(hold(driving, "fly"), driving.ticks)
    assert refused == Outcome.of(RefusalCode.NO_ACTION, action="fly", known=("forward", "back"))
    assert driving.run(100).decision.cause is DecisionCause.RLA


@pytest.mark.parametrize(("error", "cause"), [("disk full", DecisionCause.UNSAVED), (None, DecisionCause.BLIND)])
def test_hold_neither_drives_nor_teaches_blind_or_unsaved(
    driving: Corridor, error: str | None, cause: DecisionCause
) -> None:
    driving.notebook.saving_error = error
    driving.robot.infrared_age_s = 0.0 if error else 1.0
    for record in held(driving, 30, 140):
        assert (record.decision.cause, record.guard_result.wheel_speeds) == (cause, STANDSTILL)
    assert events(driving) == []


def test_no_lesson_near_a_change_of_the_held_action(driving: Corridor) -> None:
    held(driving, 40, 100, "forward")
    before = len(events(driving))
    changed = driving.ticks + 1
    for _ in range(100):
        driving.run(150, hold(driving))
    first = int(events(driving)[before][0].rpartition("/")[2])
    assert first >= changed + 2 * STEADY
    match = driving.system.match(driving.school.recent.situation(first - DELAY - STEADY))
    assert match is not None
    assert match.rla.action == "back"


def test_hold_of_what_the_robot_does_teaches_nothing(driving: Corridor) -> None:
    held(driving, 200, 105, "forward")
    outcome = driving.run(105, release()).results[0].outcome
    assert outcome == Outcome.of(ResultCode.HOLD_RELEASED, lessons=0, lesson=None)
    assert "already" in text_of(outcome)
    assert events(driving) == []


@pytest.mark.parametrize("lesson", [None, "Ann-hold-7"])
def test_undo_of_a_hold_undoes_all_its_lessons_at_once(driving: Corridor, lesson: str | None) -> None:
    before = driving.system.knowledge_hash()
    hold_through_the_unknown(driving)
    given = events(driving)
    record = driving.run(100, release(), Undo("u-1", "Ann", lesson))
    assert record.results[1].outcome == Outcome.of(ResultCode.HOLD_UNDONE, lessons=len(given))
    assert record.results[1].lesson
    undone = [event for event in record.events if isinstance(event, LessonUndone)]
    assert [event.lesson for event in undone] == [each for each, _ in reversed(given)]
    assert [event.origin.command_id for event in undone] == [
        *[f"u-1/{number}" for number in range(1, len(given))],
        "u-1",
    ]
    assert driving.system.knowledge_hash() == before
    again = driving.run(100, Undo("u-2", "Ann", "Ann-hold-7"))
    assert again.results[0].code is RefusalCode.UNDONE_ALREADY


def test_undo_of_one_lesson_of_a_hold_leaves_the_others(driving: Corridor) -> None:
    hold_through_the_unknown(driving)
    driving.run(100, release())
    *others, (last, _) = events(driving)
    assert driving.run(100, Undo("u-1", "Ann", last)).results[0].code is ResultCode.LESSON_UNDONE
    assert driving.run(100, Undo("u-2", "Ann", "Ann-hold-7")).results[0].outcome == Outcome.of(
        ResultCode.HOLD_UNDONE, lessons=len(others)
    )


def test_undo_of_a_hold_is_refused_below_a_later_lesson(driving: Corridor) -> None:
    driving.run(100, hold(driving))
    driving.run(100, release())
    driving.run(100, Correct("later", "Ann", "forward"))
    (result,) = driving.run(100, Undo("u-1", "Ann", "Ann-hold-7")).results
    assert (result.code, result.outcome.fields["later"]) == (RefusalCode.TAUGHT_AFTER, "later")
    driving.run(100, Undo("u-2", "Ann"))
    assert driving.run(100, Undo("u-3", "Ann", "Ann-hold-7")).results[0].accepted
    assert actions(driving) == {1: "forward"}


def test_hold_of_another_run_gets_an_id_of_its_own(driving: Corridor) -> None:
    driving.run(100, hold(driving))
    driving.run(100, release())
    driving.school.authority.reset_sequence("Ann")
    driving.run(100, Undo("u", "Ann"))
    for _ in range(20):
        driving.run(110)
    driving.run(110, hold(driving))
    assert [each for each, _ in events(driving)] == ["Ann-hold-7/202", f"Ann-hold-7-2/{driving.ticks}"]


def test_ids_of_holds_are_refused_in_commands(driving: Corridor) -> None:
    (result,) = driving.run(100, Teach("Ann-hold-7/5", "Ann", "back")).results
    assert result.code is RefusalCode.RESERVED_ID


def condition(corridor: Corridor, tick: int) -> tuple[float, ...]:
    return tuple(corridor.school.recent.situation(tick).tolist())


def hold_through_the_unknown(corridor: Corridor) -> None:
    """Hold an action while the situation leaves all that the robot knows."""
    for counts in range(100, 400, 3):
        held(corridor, 2, counts)
    held(corridor, 20, 400)


def test_hold_that_yields_leaves_an_answer_as_it_is() -> None:
    corridor = Corridor(answers_override_holds=True)
    corridor.run(100, teach("forward", "answer"))
    for _ in range(200):
        corridor.run(100)
    held(corridor, NOTICED + DELAY + 3 * STEADY, 100)
    assert actions(corridor) == {1: "forward"}
