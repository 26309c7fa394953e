"""Takes lessons back in a knowledge file that no robot runs on."""

import math
import uuid
from collections.abc import Iterable, Sequence
from pathlib import Path

from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.fold import fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.statistics import FIRST_VALUE, VALUES_INCLUDE, Statistics
from kurt2rt.reinforcement.reinforcement import Reinforcement
from kurt2rt.reinforcement.settings import ReinforcementSettings, TaughtWorths
from kurt2rt.rla.lesson_book import LessonRecord
from kurt2rt.rla.rla import LessonUndone, Origin, Phase, TeachingEvent
from kurt2rt.rla.rla_system import RlaSystem
from kurt2rt.teaching.recent import RecentDecisions


def undo_lesson(path: Path, lesson: str | None, *, teacher: str, stamp: str) -> LessonRecord:
    """Undo the lesson of that command id, None: the last that stands; durable on return. Returns what was undone.

    Values become what a robot would make of it: those whom a reward was given lose its credits, and an RLA that gets
    its former action back is worth what that one had earned, as far as the journal tells. Weights of edges follow when
    a robot starts next. Raises KnowledgeError, and changes nothing, where there is no such lesson, a newer one stands
    in its way, or a robot runs on the file.
    """
    with _open_again(path) as journal:
        system = fold_journal(journal, radius=math.inf)
        command_id = lesson if lesson is not None else system.last_standing_lesson
        if command_id is None:
            raise KnowledgeError(f"{path}: holds no lesson that stands; there is nothing to undo")
        problem = system.why_not_undo(command_id)
        if problem is not None:
            raise KnowledgeError(f"{path}: {problem}; kurt2rt knowledge lessons shows their ids")
        (record,) = _undo(journal, system, [command_id], teacher, stamp)
    return record


def undo_lessons_of(path: Path, taught_by: str, *, teacher: str, stamp: str) -> tuple[LessonRecord, ...]:
    """Undo all standing lessons of the teacher `taught_by`, the newest first, in one transaction.

    Returns them in that order. As `undo_lesson`; nothing at all is changed where somebody else's later lesson stands
    in the way of one of them.
    """
    with _open_again(path) as journal:
        system = fold_journal(journal, radius=math.inf)
        standing = [record for record in system.lessons if not record.undone]
        own = [record.event.origin.command_id for record in standing if record.event.origin.teacher == taught_by]
        if not own:
            teachers = ", ".join(sorted({record.event.origin.teacher for record in standing}))
            others = f"those that stand are by {teachers}" if teachers else "there is nothing to undo"
            raise KnowledgeError(f"{path}: holds no lesson by {taught_by} that stands; {others}")
        return _undo(journal, system, own[::-1], teacher, stamp)


def _undo(
    journal: Journal, system: RlaSystem, command_ids: Iterable[str], teacher: str, stamp: str
) -> tuple[LessonRecord, ...]:
    """Undo lessons in this order, all or none."""
    events, statistics = journal.events(), journal.statistics()
    undone, entries = [], []
    for command_id in command_ids:
        problem = system.why_not_undo(command_id)
        if problem is not None:
            raise KnowledgeError(f"{journal.path}: nothing was undone: {problem}")
        # No robot runs, so there is no tick; taking back is a correction.
        origin = Origin(f"undo-{uuid.uuid4().hex}", teacher, Phase.CORRECTIONS, tick=0)
        event = LessonUndone(command_id, origin)
        system.apply(event)
        record = system.lesson(command_id)
        assert record is not None
        undone.append(record)
        entries.append(JournalEntry(event, stamp))
    undos = [entry.event for entry in entries]
    journal.append_and_checkpoint(entries, _after(events, undos, statistics, len(journal.binding.feature_names)))
    return tuple(undone)


def _after(
    events: Sequence[TeachingEvent], undos: Iterable[TeachingEvent], saved: Statistics, dimensions: int
) -> Statistics:
    """What the statistics become, by the same account as a robot keeps."""
    if not saved.values and VALUES_INCLUDE not in saved.numbers:
        return saved  # credits of another rule
    first_value = saved.numbers.get(FIRST_VALUE, TaughtWorths().first_value)
    settings = ReinforcementSettings(with_teacher=TaughtWorths(first_value=first_value, highest_value=None))
    system = RlaSystem(dimensions, math.inf)
    account = Reinforcement(system, RecentDecisions(dimensions), settings, period_s=0.01)
    account.recall(events, saved)
    for event in undos:
        system.apply(event)
        account.hear(event)
    return account.to_save()


def _open_again(path: Path) -> Journal:
    """To write in a file that is there, whatever task it belongs to. Raises KnowledgeError."""
    with Journal.read_only(path) as look:
        binding = look.binding
    return Journal.open(path, binding)
