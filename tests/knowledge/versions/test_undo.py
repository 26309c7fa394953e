"""Lessons are taken back in a file that no robot runs on."""

from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import Lesson, LessonUndone, RlaCreated, RlaRewarded
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.core.rla.statistics import FIRST_VALUE, VALUES_INCLUDE, Statistics
from kurt2rt.core.teaching.commands import Undo
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.versions.undo import apply_plan, plan_redo, plan_undo
from tests.core.reinforcement.helpers import SIGNALS_ONLY, Track
from tests.core.rla.helpers import created as known_at
from tests.knowledge.lessons import BINDING, STAMP, append, begun, created, deleted, origin, replaced, rewarded
from tests.knowledge.reading import folded
from tests.knowledge.refusals import refused
from tests.teacher.helpers import teach


def undo(path: Path, lesson: str | None = None) -> LessonRecord:
    planned = plan_undo(path, lesson, teacher="command line")
    apply_plan(planned, STAMP)
    (record,) = planned.lessons
    return record


def undo_all_of(path: Path, teacher: str) -> tuple[LessonRecord, ...]:
    planned = plan_undo(path, taught_by=teacher, teacher="command line")
    apply_plan(planned, STAMP)
    return planned.lessons


def redo(path: Path, lesson: str | None = None) -> LessonRecord:
    planned = plan_redo(path, lesson, teacher="command line")
    apply_plan(planned, STAMP)
    (record,) = planned.lessons
    return record


def test_redo_last_undo_comes_first_with_its_value(path: Path) -> None:
    with Journal.open(begun(path, lessons=2), BINDING) as journal:
        blame = RlaRewarded(1, -1, 390, origin("blame-1"), (Credit(1, -0.25),))
        journal.append([JournalEntry(blame, STAMP), JournalEntry(replaced(2, "left", "forward"), STAMP)])
        journal.checkpoint(Statistics(values={1: 0.25}, numbers={FIRST_VALUE: 0.5, VALUES_INCLUDE: 4.0}))
    undo(path, "blame-1")
    undo(path)
    assert redo(path) == LessonRecord(replaced(2, "left", "forward"))
    assert folded(path).rlas[1].action == "left"
    assert redo(path) == LessonRecord(blame)
    with Journal.read_only(path) as journal:
        assert journal.statistics().values == {1: 0.25}
    with refused(KnowledgeCode.NO_LESSON, path):
        redo(path)


def test_apply_plan_changed_file_is_refused(path: Path) -> None:
    begun(path, lessons=2)
    planned = plan_undo(path, teacher="command line")
    assert [record.event for record in planned.lessons] == [created(2)]
    append(path, created(3))
    apply_plan(planned, STAMP)  # not the lesson that came meanwhile
    assert folded(path).rlas == (created(1).rla, created(3).rla)
    with refused(KnowledgeCode.LESSON_REFUSED, outcome=RefusalCode.UNDONE_ALREADY):
        apply_plan(planned, STAMP)
    assert folded(path).rlas == (created(1).rla, created(3).rla)


def redo_all_of(path: Path, teacher: str) -> tuple[tuple[LessonRecord, ...], tuple[Outcome, ...]]:
    planned = plan_redo(path, taught_by=teacher, teacher="command line")
    apply_plan(planned, STAMP)
    return planned.lessons, planned.stay


def test_redo_all_of_a_teacher_restores_all(path: Path) -> None:
    with Journal.open(begun(path), BINDING) as journal:
        taught = (
            replaced(1, "left", "forward"),
            deleted(1),
            rewarded(2, command_id="praise"),
            replaced(2, "left", "forward"),
        )
        journal.append([JournalEntry(event, STAMP) for event in taught])
    before = folded(path).rlas
    undo_all_of(path, "Hertha")
    assert folded(path).rlas == ()
    redone, reasons = redo_all_of(path, "Hertha")
    assert [record.event for record in redone] == [*(created(number) for number in (1, 2, 3)), *taught]
    assert reasons == ()
    assert folded(path).rlas == before
    with refused(KnowledgeCode.NO_UNDONE_LESSON_BY, teacher="Hertha"):
        redo_all_of(path, "Hertha")


def test_undo_refused_lesson_writes_nothing(path: Path) -> None:
    begun(path)
    append(path, replaced(1, "left", "forward"))
    for lesson, outcome in {"create-1": RefusalCode.TAUGHT_AFTER, "create-9": RefusalCode.NO_SUCH_LESSON}.items():
        with refused(KnowledgeCode.LESSON_REFUSED, path, outcome=outcome):
            undo(path, lesson)
    with Journal.read_only(path) as journal:
        assert len(journal.events()) == 4


def by_critic(*events: Lesson) -> list[JournalEntry]:
    """Return entries of the critic in autonomous mode."""
    return [
        JournalEntry(replace(each, origin=replace(each.origin, teacher=CRITIC, phase=Phase.AUTONOMOUS)), STAMP)
        for each in events
        if not isinstance(each, RlaCreated)
    ]


def with_critic_lessons(path: Path) -> Path:
    """Three RLAs by Hertha; the critic blamed two and had one deleted and one answered again."""
    with Journal.open(begun(path), BINDING) as journal:
        blame = RlaRewarded(1, -1, 390, origin("blame-1"), (Credit(1, -0.25), Credit(2, -0.125), Credit(9, -1.0)))
        journal.append(by_critic(blame, deleted(2), rewarded(3, 1, "praise-3"), replaced(3, "left", "forward")))
        numbers = {FIRST_VALUE: 0.5, VALUES_INCLUDE: 7.0}
        journal.checkpoint(Statistics({1: 5}, {(1, 2): 3}, {1: 0.25, 3: 0.625}, numbers))
    return path


def test_undo_all_of_the_critic_keeps_other_lessons(path: Path) -> None:
    told = undo_all_of(with_critic_lessons(path), CRITIC)

    assert [record.event.origin.command_id for record in told] == ["replace-3-left", "praise-3", "delete-2", "blame-1"]
    assert all(record.undone for record in told)
    assert folded(path).rlas == (created(1).rla, created(2).rla, created(3).rla)
    with Journal.read_only(path) as journal:
        undos = [event for event in journal.events() if isinstance(event, LessonUndone)]
        assert [event.lesson for event in undos] == [record.event.origin.command_id for record in told]
        assert len({event.origin.command_id for event in undos}) == 4
    with refused(KnowledgeCode.NO_LESSON_BY, teacher=CRITIC):
        undo_all_of(path, CRITIC)


LINE = KnowledgeBinding("0123", ("place",), "wall following", "kurt2")


@pytest.mark.parametrize("saved_late", [True, False])
def test_undo_in_a_file_equals_the_undo_of_a_robot(path: Path, *, saved_late: bool) -> None:
    """Blamed until it asks, answered again, and the answer blamed as well: then all of it is undone."""
    robot = Track(known_at(1, (0.0,), "a"), known_at(2, (50.0,), "b"), reinforcement=SIGNALS_ONLY)
    saved = robot.reinforcement.snapshot()
    for _ in range(3):
        robot.go(0.0, 400)
        robot.signal(-1)
    robot.go(0.0)
    assert robot.say(teach("c", "again")).accepted
    robot.go(0.0, 400)
    robot.signal(-1)
    robot.go(0.0)
    if saved_late:
        saved = robot.reinforcement.snapshot()
    with Journal.open(path, LINE) as journal:
        journal.append([JournalEntry(event, STAMP) for event in robot.events])
        journal.checkpoint(saved)

    for number, lesson in enumerate(("signal-4", "again", "signal-3/withdraw-1", "signal-3", "signal-2")):
        assert robot.say(Undo(f"u-{number}", "Ann", lesson)).accepted
        assert undo(path, lesson).undone
        with Journal.read_only(path) as journal:
            statistics, events = journal.statistics(), journal.events()
        assert statistics.values == pytest.approx(robot.reinforcement.snapshot().values)
        again = Track(*events, reinforcement=SIGNALS_ONLY, saved=statistics)
        assert again.value(1) == pytest.approx(robot.value(1))
    assert robot.value(1) == pytest.approx(0.2, abs=0.01)


def test_undo_later_lesson_of_another_teacher_is_refused(path: Path) -> None:
    with Journal.open(with_critic_lessons(path), BINDING) as journal:
        journal.append([JournalEntry(rewarded(1, 1, "praise-of-hertha"), STAMP)])
        before = journal.events(), journal.statistics()
    with refused(KnowledgeCode.LESSON_REFUSED, outcome=RefusalCode.TAUGHT_AFTER):
        undo_all_of(path, CRITIC)
    with Journal.read_only(path) as journal:
        assert (journal.events(), journal.statistics()) == before
