"""Takes lessons back, or lets them stand again, in a knowledge file that no robot runs on."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.core.outcome import Outcome
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import LessonRedone, LessonUndone, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries, fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.editing import new_origin, open_for_editing, write


@dataclass(frozen=True)
class UndoPlan:
    """An undo or a redo that can be made, and is not made yet."""

    path: Path
    changes: tuple[LessonUndone | LessonRedone, ...]
    """What is to be written, in this order."""
    lessons: tuple[LessonRecord, ...]
    """The lessons that it is about, in the same order, as they are afterwards."""
    stay: tuple[str, ...]
    """Why other lessons of the same teacher stay as they are, a sentence each."""
    binding: KnowledgeBinding
    events: tuple[TeachingEvent, ...]
    """All that was taught before."""
    statistics: Statistics


def plan_undo(path: Path, lesson: str | None = None, of: str | None = None, *, teacher: str) -> UndoPlan:
    """To take back the lesson of that command id, None: the last that stands; or all of the teacher `of`, newest first.

    Reads only; it is `teacher` who undoes. Raises KnowledgeError where there is no such lesson, or a newer one stands
    in its way.
    """
    reading = _read(path)
    system = reading.system
    if of is not None:
        command_ids = _lessons_to_undo(system, of, path)
    else:
        nothing = "stands; there is nothing to undo"
        command_ids = [_lesson_meant(path, lesson, system.last_standing_lesson, system.why_not_undo, nothing)]
    changes = [LessonUndone(command_id, new_origin("undo", teacher)) for command_id in command_ids]
    _apply(system, changes, f"{path}: nothing was undone")
    return reading.planned(changes)


def plan_redo(path: Path, lesson: str | None = None, of: str | None = None, *, teacher: str) -> UndoPlan:
    """To let the lesson of that command id stand again, None: the one undone last; or all undone of the teacher `of`.

    Those go the one undone last first; one in whose place something else stands stays undone. Reads only; it is
    `teacher` who does it. Raises KnowledgeError where there is no such lesson, or none that can stand again.
    """
    reading = _read(path)
    system = reading.system
    changes, reasons = list[LessonRedone](), list[str]()
    if of is not None:
        command_ids = _undone_by_time(reading, of)
    else:
        nothing = "was undone; there is nothing to redo"
        command_ids = [_lesson_meant(path, lesson, system.last_undone_lesson, system.why_not_redo, nothing)]
    for command_id in command_ids:
        problem = system.why_not_redo(command_id)
        if problem is not None:
            reasons.append(text_of(problem))
            continue
        changes.append(LessonRedone(command_id, new_origin("redo", teacher)))
        system.apply(changes[-1])
    if not changes:
        why = f": {reasons[0]}" if reasons else ""
        raise KnowledgeError(f"holds no undone lesson by {of} that can stand again{why}", where=path)
    return reading.planned(changes, reasons)


def apply_plan(planned: UndoPlan, stamp: str) -> None:
    """Make what was planned, all or nothing; durable on return.

    Values become what a robot would make of it: those whom a reward was given lose its credits, and an RLA that gets
    its former action back is worth what that one had earned, as far as the journal tells; a reward that stands again
    is worth what it was worth then. Weights of edges follow when a robot starts next. Raises KnowledgeError, and
    changes nothing, where a robot runs on the file, or has changed it since so that it does not fit any more.
    """
    with open_for_editing(planned.path) as journal:
        _apply(fold_journal(journal, radius=math.inf), planned.changes, f"{planned.path}: nothing was changed")
        write(journal, [JournalEntry(event, stamp) for event in planned.changes])


@dataclass(frozen=True)
class _Reading:
    """What is in a file, and its fold, to plan on."""

    path: Path
    binding: KnowledgeBinding
    events: tuple[TeachingEvent, ...]
    statistics: Statistics
    system: RlaSystem

    def planned(self, changes: Sequence[LessonUndone | LessonRedone], stay: Sequence[str] = ()) -> UndoPlan:
        """These changes, which `system` has taken already."""
        records = tuple(_record(self.system, change.lesson) for change in changes)
        return UndoPlan(self.path, tuple(changes), records, tuple(stay), self.binding, self.events, self.statistics)


def _read(path: Path) -> _Reading:
    with Journal.read_only(path) as journal:
        entries, statistics = journal.read_all()
        system = fold_entries(journal, entries, radius=math.inf)
        return _Reading(path, journal.binding, tuple(entry.event for entry in entries), statistics, system)


def _lesson_meant(
    path: Path, lesson: str | None, last: str | None, why_not: Callable[[str], Outcome | None], nothing: str
) -> str:
    """The command id that was given, else the `last` one. Raises KnowledgeError where it cannot be done with that."""
    command_id = lesson if lesson is not None else last
    if command_id is None:
        raise KnowledgeError(f"holds no lesson that {nothing}", where=path)
    problem = why_not(command_id)
    if problem is not None:
        raise KnowledgeError(text_of(problem), where=path, do="kurt2rt knowledge lessons shows their ids")
    return command_id


def _lessons_to_undo(system: RlaSystem, taught_by: str, path: Path) -> list[str]:
    """Command ids of all standing lessons of a teacher, newest first."""
    standing = [record for record in system.lessons if not record.undone]
    own = [record.event.origin.command_id for record in standing if record.event.origin.teacher == taught_by]
    if not own:
        teachers = ", ".join(sorted({record.event.origin.teacher for record in standing}))
        others = f"those that stand are by {teachers}" if teachers else "there is nothing to undo"
        raise KnowledgeError(f"holds no lesson by {taught_by} that stands", where=path, do=others)
    return own[::-1]


def _undone_by_time(reading: _Reading, taught_by: str) -> list[str]:
    """Command ids of a teacher's lessons that do not stand, the one undone last first: as they came off, they go on."""
    undone = dict[str, None]()
    for event in reading.events:
        if isinstance(event, LessonUndone):
            undone.pop(event.lesson, None)
            undone[event.lesson] = None
    records = ((command_id, reading.system.lesson(command_id)) for command_id in reversed(undone))
    return [
        command_id
        for command_id, record in records
        if record is not None and record.undone and record.event.origin.teacher == taught_by
    ]


def _apply(system: RlaSystem, changes: Iterable[LessonUndone | LessonRedone], refusal: str) -> None:
    """Raises KnowledgeError, which begins with `refusal`, at the first one that does not fit."""
    for change in changes:
        undoes = isinstance(change, LessonUndone)
        problem = system.why_not_undo(change.lesson) if undoes else system.why_not_redo(change.lesson)
        if problem is not None:
            raise KnowledgeError(text_of(problem), where=refusal)
        system.apply(change)


def _record(system: RlaSystem, command_id: str) -> LessonRecord:
    record = system.lesson(command_id)
    assert record is not None
    return record
