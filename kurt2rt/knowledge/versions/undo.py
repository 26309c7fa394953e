"""Undo and redo of lessons in a knowledge file that no robot runs on."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.events import LessonRedone, LessonUndone, TeachingEvent
from kurt2rt.core.rla.lesson_history import DERIVED, LessonRecord
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries, fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.editing import append_with_values, new_origin, open_for_editing


@dataclass(frozen=True)
class UndoPlan:
    """Checked undo or redo in a knowledge file that can be previewed and then written by `apply_plan`."""

    path: Path
    changes: tuple[LessonUndone | LessonRedone, ...]
    """Events to write, in this order."""
    lessons: tuple[LessonRecord, ...]
    """Their lessons, in the same order, as they are afterwards."""
    stay: tuple[Outcome, ...]
    """Refusals of other lessons of the same teacher, which stay as they are."""
    binding: KnowledgeBinding
    events: tuple[TeachingEvent, ...]
    """All that was taught before."""
    statistics: Statistics


def plan_undo(path: Path, lesson: str | None = None, taught_by: str | None = None, *, teacher: str) -> UndoPlan:
    """Plan the undo of one lesson, of a hold or merge, or of all lessons of a teacher that stand, newest first.

    It only reads the file.

    Args:
        path: of the knowledge file.
        lesson: command id of the lesson, or id of a hold or merge; None: the last lesson that stands.
        taught_by: the teacher of all lessons to undo; None: one lesson.
        teacher: who undoes.

    Raises:
        KnowledgeError: there is no such lesson, or a newer lesson has to be undone first.
    """
    reading = _read(path)
    system = reading.system
    if taught_by is not None:
        command_ids = _lessons_to_undo(system, taught_by, path)
    elif lesson is not None and (together := _together(system, lesson)):
        command_ids = [each for each in together[::-1] if not _record(system, each).undone]
        if not command_ids:
            _require_possible(Outcome.of(RefusalCode.UNDONE_ALREADY, lesson=lesson), path)
    else:
        state = "stands; there is nothing to undo"
        command_ids = [_select(path, lesson, system.history.last_standing, system.history.why_not_undo, state)]
    changes = [LessonUndone(command_id, new_origin("undo", teacher)) for command_id in command_ids]
    _apply(system, changes, f"{path}: nothing was undone")
    return reading.planned(changes)


def plan_redo(path: Path, lesson: str | None = None, taught_by: str | None = None, *, teacher: str) -> UndoPlan:
    """Plan the redo of one lesson, of a hold or merge, or of a teacher's undone lessons; only reads the file.

    Of several lessons, those in whose place another lesson stands stay undone.

    Args:
        path: of the knowledge file.
        lesson: command id of the lesson, or id of a hold or merge; None: the one undone last.
        taught_by: the teacher of all lessons to redo; None: one lesson.
        teacher: who redoes.

    Raises:
        KnowledgeError: there is no such lesson, or none that can stand again.
    """
    reading = _read(path)
    system = reading.system
    changes, refusals = list[LessonRedone](), list[Outcome]()
    if taught_by is not None:
        command_ids = _undone_by_time(reading, taught_by)
    elif lesson is not None and (together := _together(system, lesson)):
        command_ids = [each for each in together if _record(system, each).undone]
        if not command_ids:
            _require_possible(Outcome.of(RefusalCode.STANDS_ALREADY, lesson=lesson), path)
    else:
        state = "was undone; there is nothing to redo"
        command_ids = [_select(path, lesson, system.history.last_undone, system.history.why_not_redo, state)]
    for command_id in command_ids:
        refusal = system.history.why_not_redo(command_id)
        if refusal is not None:
            refusals.append(refusal)
            continue
        changes.append(LessonRedone(command_id, new_origin("redo", teacher)))
        system.apply(changes[-1])
    if not changes:
        if taught_by is None:  # a hold or merge, whose places are all taken
            _require_possible(refusals[0], path)
        reason = f": {text_of(refusals[0])}" if refusals else ""
        raise KnowledgeError(KnowledgeCode.NO_UNDONE_LESSON_BY, where=path, teacher=taught_by, reason=reason)
    return reading.planned(changes, refusals)


def apply_plan(planned: UndoPlan, stamp: str) -> None:
    """Write a plan, all or nothing; durable on return.

    Values become as a robot computes them: RLAs lose the credits of an undone reward, and an RLA with its former action
    has the value earned with that action, as far as the journal shows. A redone reward counts as it did. Weights of
    edges follow when a robot starts next.

    Args:
        planned: of `plan_undo` or `plan_redo`.
        stamp: of the rows, UTC, ISO 8601.

    Raises:
        KnowledgeError: a robot runs on the file, or has changed it so that the plan does not fit; nothing is changed.
    """
    with open_for_editing(planned.path) as journal:
        _apply(fold_journal(journal, radius=math.inf), planned.changes, f"{planned.path}: nothing was changed")
        append_with_values(journal, [JournalEntry(event, stamp) for event in planned.changes])


@dataclass(frozen=True)
class _Reading:
    """Content of a file, and its fold, to plan on."""

    path: Path
    binding: KnowledgeBinding
    events: tuple[TeachingEvent, ...]
    statistics: Statistics
    system: RlaSystem

    def planned(self, changes: Sequence[LessonUndone | LessonRedone], stay: Sequence[Outcome] = ()) -> UndoPlan:
        """Return the plan of these changes, which were applied to `system`."""
        records = tuple(_record(self.system, change.lesson) for change in changes)
        return UndoPlan(self.path, tuple(changes), records, tuple(stay), self.binding, self.events, self.statistics)


def _read(path: Path) -> _Reading:
    with Journal.read_only(path) as journal:
        entries, statistics = journal.read_all()
        system = fold_entries(journal, entries, radius=math.inf)
        return _Reading(path, journal.binding, tuple(entry.event for entry in entries), statistics, system)


def _select(
    path: Path, lesson: str | None, last: str | None, why_not: Callable[[str], Outcome | None], state: str
) -> str:
    """Return the command id `lesson`, by default `last`; KnowledgeError if there is none or `why_not` refuses it."""
    command_id = lesson if lesson is not None else last
    if command_id is None:
        raise KnowledgeError(KnowledgeCode.NO_LESSON, where=path, state=state)
    _require_possible(why_not(command_id), path)
    return command_id


def _require_possible(refusal: Outcome | None, where: object) -> None:
    if refusal is not None:
        raise KnowledgeError(KnowledgeCode.LESSON_REFUSED, where=where, reason=text_of(refusal), outcome=refusal.code)


def _together(system: RlaSystem, command: str) -> list[str]:
    """Return the command ids of the lessons of a hold or merge, oldest first; empty for one lesson of this id."""
    command_ids = [record.event.origin.command_id for record in system.history.records]
    return [] if command in command_ids else [each for each in command_ids if each.startswith(f"{command}{DERIVED}")]


def _lessons_to_undo(system: RlaSystem, taught_by: str, path: Path) -> list[str]:
    """Return the command ids of all standing lessons of a teacher, newest first."""
    standing = [record for record in system.history.records if not record.undone]
    own = [record.event.origin.command_id for record in standing if record.event.origin.teacher == taught_by]
    if not own:
        teachers = ", ".join(sorted({record.event.origin.teacher for record in standing}))
        others = f"those that stand are by {teachers}" if teachers else "there is nothing to undo"
        raise KnowledgeError(KnowledgeCode.NO_LESSON_BY, where=path, teacher=taught_by, others=others)
    return own[::-1]


def _undone_by_time(reading: _Reading, taught_by: str) -> list[str]:
    """Return the command ids of a teacher's undone lessons, the last undo first: the reverse of their undos."""
    undone = dict[str, None]()
    for event in reading.events:
        if isinstance(event, LessonUndone):
            undone.pop(event.lesson, None)
            undone[event.lesson] = None
    records = ((command_id, reading.system.history.get(command_id)) for command_id in reversed(undone))
    return [
        command_id
        for command_id, record in records
        if record is not None and record.undone and record.event.origin.teacher == taught_by
    ]


def _apply(system: RlaSystem, changes: Iterable[LessonUndone | LessonRedone], where: str) -> None:
    """Apply changes in order; raise KnowledgeError at `where` for the first one that does not fit."""
    for change in changes:
        why_not = system.history.why_not_undo if isinstance(change, LessonUndone) else system.history.why_not_redo
        _require_possible(why_not(change.lesson), where)
        system.apply(change)


def _record(system: RlaSystem, command_id: str) -> LessonRecord:
    record = system.history.get(command_id)
    assert record is not None
    return record
