"""Redo of lessons."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.events import Appraised, InvalidEventError, LessonRedone, TeachingEvent
from kurt2rt.core.rla.rla import ASK
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import (
    created,
    deleted,
    named,
    origin,
    refused_by,
    replaced,
    rewarded,
    system_of,
    undone,
    withdrawn,
)
from tests.examples import examples

FIRST = created(1, (0.0, 0.0))
SECOND = created(2, (9.0, 0.0), "left")


def redone(lesson: str) -> LessonRedone:
    return LessonRedone(lesson, origin(f"redo-{lesson}", 4500))


@pytest.mark.parametrize(
    "lesson",
    [
        created(3, (4.0, 0.0), command_id="it"),
        replaced(1, "back", "forward", "it"),
        withdrawn(1, command_id="it"),
        deleted(1, "it"),
        rewarded(1, -1, "it"),
        named("door", (1.0, 2.0), command_id="it"),
    ],
)
def test_redo_after_undo_restores_the_knowledge(lesson: TeachingEvent) -> None:
    taught = system_of(FIRST, SECOND, lesson)
    again = system_of(FIRST, SECOND, lesson, undone("it"), redone("it"))
    assert again.knowledge_hash() == taught.knowledge_hash()
    assert (again.rlas, again.history.records, again.next_id) == (taught.rlas, taught.history.records, taught.next_id)
    assert again.named_situations("basic") == taught.named_situations("basic")
    assert again.appraisal(1) == taught.appraisal(1)
    assert again.history.last_standing == "it"
    assert again.history.last_undone is None
    again.apply(undone("it"))
    assert again.knowledge_hash() == system_of(FIRST, SECOND).knowledge_hash()


def test_redo_several_in_taught_order_only() -> None:
    system = system_of(FIRST, replaced(1, "back", "forward", "a"), replaced(1, "left", "back", "b"))
    for lesson in ("b", "a", "lesson-1"):
        system.apply(undone(lesson))
    refusal = refused_by(system, redone("b")).refusal
    assert refusal is not None
    assert (refusal.code, refusal.fields["earlier"]) == (RefusalCode.STANDS_ON_UNDONE, "a")
    for lesson in ("lesson-1", "a", "b"):
        assert system.history.last_undone == lesson
        system.apply(redone(lesson))
    assert [rla.action for rla in system.rlas] == ["left"]


def test_redo_replaced_lesson_is_refused() -> None:
    system = system_of(FIRST, replaced(1, "back", "forward", "a"), undone("a"), replaced(1, ASK + "ed", "forward", "b"))
    refusal = refused_by(system, redone("a")).refusal
    assert refusal is not None
    assert (refusal.code, refusal.fields["later"]) == (RefusalCode.TAUGHT_INSTEAD, "b")
    system.apply(undone("b"))
    system.apply(redone("a"))
    assert [rla.action for rla in system.rlas] == ["back"]


def test_redo_standing_or_unknown_lesson_is_refused() -> None:
    system = system_of(FIRST)
    assert system.history.why_not_redo("lesson-1") == Outcome.of(RefusalCode.STANDS_ALREADY, lesson="lesson-1")
    assert system.history.why_not_redo("lesson-9") == Outcome.of(RefusalCode.NO_SUCH_LESSON, lesson="lesson-9")


@examples(100)
@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 30)), max_size=40))
def test_redo_random_sequences_equal_standing_lessons(steps: list[tuple[int, int]]) -> None:
    system = RlaSystem(2, 5.0)
    for number, (what, which) in enumerate(steps):
        living = [rla.rla_id for rla in system.rlas]
        lessons = [record.event.origin.command_id for record in system.history.records]
        event: TeachingEvent = Appraised("good", 1, 1, origin(f"nothing-{number}"))
        if what == 0 or not living:
            event = created(system.next_id, (float(which), 0.0), f"a{number}", command_id=f"c{number}")
        elif what in (1, 2):
            one = living[which % len(living)]
            event = replaced(one, f"r{number}", "", f"c{number}") if what == 1 else deleted(one, f"c{number}")
        elif what == 3 and lessons:
            event = undone(lessons[which % len(lessons)])
        elif lessons:
            event = redone(lessons[which % len(lessons)])
        try:
            system.apply(event)
        except InvalidEventError:
            assert isinstance(event, type(undone("x")) | LessonRedone)
    standing = RlaSystem(2, 5.0)
    standing.apply_all(record.event for record in system.history.records if not record.undone)
    assert system.rlas == standing.rlas
    assert system.knowledge_hash() == standing.knowledge_hash()
    assert system.history.last_standing == standing.history.last_standing
    assert system.history.standing == standing.history.standing
