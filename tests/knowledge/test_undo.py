"""A lesson is taken back in a file that no robot runs on."""

from pathlib import Path

import pytest

from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.fold import check_knowledge, fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.undo import undo_lesson
from kurt2rt.rla.lesson_book import LessonRecord
from kurt2rt.rla.rla import LessonUndone, Rla
from tests.knowledge.lessons import BINDING, STAMP, begun, created, deleted, replaced


def rlas(path: Path) -> tuple[Rla, ...]:
    with Journal.read_only(path) as journal:
        assert check_knowledge(journal) == []
        return fold_journal(journal, radius=1.0).rlas


def undo(path: Path, lesson: str | None = None) -> LessonRecord:
    return undo_lesson(path, lesson, teacher="command line", stamp=STAMP)


def test_the_last_lesson_that_stands_is_undone_and_the_one_before_it_next(path: Path) -> None:
    begun(path, lessons=2)
    with Journal.open(path, BINDING) as journal:
        journal.append([JournalEntry(deleted(1), STAMP)])

    assert undo(path) == LessonRecord(deleted(1), undone=True)
    assert rlas(path) == (created(1).rla, created(2).rla)
    assert undo(path) == LessonRecord(created(2), undone=True)
    assert undo(path) == LessonRecord(created(1), undone=True)
    assert rlas(path) == ()
    with pytest.raises(KnowledgeError, match=f"^{path}: holds no lesson that stands; there is nothing to undo$"):
        undo(path)


def test_the_journal_tells_who_undid_what(path: Path) -> None:
    undo(begun(path), "create-2")
    with Journal.read_only(path) as journal:
        *_, last = journal.entries()

    assert isinstance(last.event, LessonUndone)
    assert (last.event.lesson, last.event.origin.teacher, last.stamped_at) == ("create-2", "command line", STAMP)


def test_a_lesson_that_cannot_be_undone_is_refused_and_nothing_is_written(path: Path) -> None:
    begun(path)
    with Journal.open(path, BINDING) as journal:
        journal.append([JournalEntry(replaced(1, "left", "forward"), STAMP)])
    for lesson, why in {
        "create-1": "'replace-1-left' came after 'create-1' .*; undo that one first; kurt2rt knowledge lessons shows",
        "create-9": "there is no lesson 'create-9'; kurt2rt knowledge lessons shows their ids",
    }.items():
        with pytest.raises(KnowledgeError, match=why):
            undo(path, lesson)
    with Journal.read_only(path) as journal:
        assert len(journal.events()) == 4


def test_nothing_is_undone_under_a_running_robot(path: Path) -> None:
    with Journal.open(path, BINDING), pytest.raises(KnowledgeError, match="another kurt2rt is writing it"):
        undo(path)
