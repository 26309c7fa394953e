"""Takes lessons back, or lets them stand again, in a knowledge file that no robot runs on."""

import math
from collections.abc import Callable, Iterable
from pathlib import Path

from kurt2rt.knowledge.changing import new_origin, open_again, write
from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.fold import fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.rla.lesson_book import LessonRecord
from kurt2rt.rla.rla import LessonRedone, LessonUndone
from kurt2rt.rla.rla_system import RlaSystem


def undo_lesson(path: Path, lesson: str | None, *, teacher: str, stamp: str) -> LessonRecord:
    """Undo the lesson of that command id, None: the last that stands; durable on return. Returns what was undone.

    Values become what a robot would make of it: those whom a reward was given lose its credits, and an RLA that gets
    its former action back is worth what that one had earned, as far as the journal tells. Weights of edges follow when
    a robot starts next. Raises KnowledgeError, and changes nothing, where there is no such lesson, a newer one stands
    in its way, or a robot runs on the file.
    """
    with open_again(path) as journal:
        system = fold_journal(journal, radius=math.inf)
        command_id = lesson_to_undo(system, lesson, path)
        (record,) = _undo(journal, system, [command_id], teacher, stamp)
    return record


def lesson_to_undo(system: RlaSystem, lesson: str | None, path: Path) -> str:
    """Command id of the lesson that can be undone, None: the last that stands. Raises KnowledgeError."""
    command_id = lesson if lesson is not None else system.last_standing_lesson
    if command_id is None:
        raise KnowledgeError(f"{path}: holds no lesson that stands; there is nothing to undo")
    problem = system.why_not_undo(command_id)
    if problem is not None:
        raise KnowledgeError(f"{path}: {problem}; kurt2rt knowledge lessons shows their ids")
    return command_id


def undo_lessons_of(path: Path, taught_by: str, *, teacher: str, stamp: str) -> tuple[LessonRecord, ...]:
    """Undo all standing lessons of the teacher `taught_by`, the newest first, in one transaction.

    Returns them in that order. As `undo_lesson`; nothing at all is changed where somebody else's later lesson stands
    in the way of one of them.
    """
    with open_again(path) as journal:
        system = fold_journal(journal, radius=math.inf)
        return _undo(journal, system, lessons_to_undo(system, taught_by, path), teacher, stamp)


def lessons_to_undo(system: RlaSystem, taught_by: str, path: Path) -> list[str]:
    """Command ids of all standing lessons of a teacher, newest first. Raises KnowledgeError where there is none."""
    standing = [record for record in system.lessons if not record.undone]
    own = [record.event.origin.command_id for record in standing if record.event.origin.teacher == taught_by]
    if not own:
        teachers = ", ".join(sorted({record.event.origin.teacher for record in standing}))
        others = f"those that stand are by {teachers}" if teachers else "there is nothing to undo"
        raise KnowledgeError(f"{path}: holds no lesson by {taught_by} that stands; {others}")
    return own[::-1]


def redo_lesson(path: Path, lesson: str | None, *, teacher: str, stamp: str) -> LessonRecord:
    """Let the lesson of that command id stand again, None: the one undone last; durable on return. Returns it.

    Values as in `undo_lesson`. Raises KnowledgeError, and changes nothing, where there is no such lesson, its RLA is
    not as the lesson found it, or a robot runs on the file.
    """
    with open_again(path) as journal:
        system = fold_journal(journal, radius=math.inf)
        command_id = lesson if lesson is not None else system.last_undone_lesson
        if command_id is None:
            raise KnowledgeError(f"{path}: holds no lesson that was undone; there is nothing to redo")
        problem = system.why_not_redo(command_id)
        if problem is not None:
            raise KnowledgeError(f"{path}: {problem}; kurt2rt knowledge lessons shows their ids")
        event = LessonRedone(command_id, new_origin("redo", teacher))
        system.apply(event)
        write(journal, [JournalEntry(event, stamp)])
        return _record(system, command_id)


def redo_lessons_of(
    path: Path, taught_by: str, *, teacher: str, stamp: str
) -> tuple[tuple[LessonRecord, ...], tuple[str, ...]]:
    """Let all undone lessons of the teacher `taught_by` stand again, the one undone last first, in one transaction.

    Returns them in that order, and why others stay undone, a sentence each: something else stands in their place.
    As `redo_lesson`; raises KnowledgeError where none can stand again.
    """
    with open_again(path) as journal:
        system = fold_journal(journal, radius=math.inf)
        events, reasons = list[LessonRedone](), list[str]()
        for command_id in _undone_by_time(journal, system, taught_by):
            problem = system.why_not_redo(command_id)
            if problem is not None:
                reasons.append(problem)
                continue
            event = LessonRedone(command_id, new_origin("redo", teacher))
            system.apply(event)
            events.append(event)
        if not events:
            why = f": {reasons[0]}" if reasons else ""
            raise KnowledgeError(f"{path}: holds no undone lesson by {taught_by} that can stand again{why}")
        write(journal, [JournalEntry(event, stamp) for event in events])
        return tuple(_record(system, event.lesson) for event in events), tuple(reasons)


def _undone_by_time(journal: Journal, system: RlaSystem, taught_by: str) -> list[str]:
    """Command ids of a teacher's lessons that do not stand, the one undone last first: as they came off, they go on."""
    undone = dict[str, None]()
    for event in journal.events():
        if isinstance(event, LessonUndone):
            undone.pop(event.lesson, None)
            undone[event.lesson] = None
    records = ((command_id, system.lesson(command_id)) for command_id in reversed(undone))
    return [
        command_id
        for command_id, record in records
        if record is not None and record.undone and record.event.origin.teacher == taught_by
    ]


def undos_of(
    system: RlaSystem, command_ids: Iterable[str], teacher: str, refuse: Callable[[str], KnowledgeError]
) -> list[LessonUndone]:
    """The events that undo lessons in this order, applied to `system`. Raises what `refuse` makes of a problem."""
    events = []
    for command_id in command_ids:
        problem = system.why_not_undo(command_id)
        if problem is not None:
            raise refuse(problem)
        event = LessonUndone(command_id, new_origin("undo", teacher))
        system.apply(event)
        events.append(event)
    return events


def _undo(
    journal: Journal, system: RlaSystem, command_ids: Iterable[str], teacher: str, stamp: str
) -> tuple[LessonRecord, ...]:
    """Undo lessons in this order, all or none."""

    def refused(problem: str) -> KnowledgeError:
        return KnowledgeError(f"{journal.path}: nothing was undone: {problem}")

    events = undos_of(system, command_ids, teacher, refused)
    write(journal, [JournalEntry(event, stamp) for event in events])
    return tuple(_record(system, event.lesson) for event in events)


def _record(system: RlaSystem, command_id: str) -> LessonRecord:
    record = system.lesson(command_id)
    assert record is not None
    return record
