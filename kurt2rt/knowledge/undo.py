"""Takes a lesson back in a knowledge file that no robot runs on."""

import math
import uuid
from pathlib import Path

from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.fold import fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.rla.lesson_book import LessonRecord
from kurt2rt.rla.rla import LessonUndone, Origin, Phase


def undo_lesson(path: Path, lesson: str | None, *, teacher: str, stamp: str) -> LessonRecord:
    """Undo the lesson of that command id, None: the last that stands; durable on return. Returns what was undone.

    Raises KnowledgeError, and changes nothing, where there is no such lesson, a newer one stands in its way, or a
    robot runs on the file.
    """
    with Journal.read_only(path) as look:
        binding = look.binding
    with Journal.open(path, binding) as journal:
        system = fold_journal(journal, radius=math.inf)
        command_id = lesson if lesson is not None else system.last_standing_lesson
        if command_id is None:
            raise KnowledgeError(f"{path}: holds no lesson that stands; there is nothing to undo")
        problem = system.why_not_undo(command_id)
        if problem is not None:
            raise KnowledgeError(f"{path}: {problem}; kurt2rt knowledge lessons shows their ids")
        # No robot runs, so there is no tick; taking back is a correction.
        origin = Origin(f"undo-{uuid.uuid4().hex}", teacher, Phase.CORRECTIONS, tick=0)
        event = LessonUndone(command_id, origin)
        journal.append([JournalEntry(event, stamp)])
        system.apply(event)
    record = system.lesson(command_id)
    assert record is not None
    return record
