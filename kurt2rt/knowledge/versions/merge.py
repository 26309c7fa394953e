"""Merge: the lessons that stand in another knowledge file are appended to this one.

A lesson that is here already is skipped, also if it was undone here. One that corrects, withdraws, deletes or rewards
an RLA, or moves a name, comes only if it finds here what it found there. New RLAs get new ids, and all command ids
begin with that of the merge, so that its lessons can be undone together.
"""

import math
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import Lesson, RlaCreated, RlaRewarded, SituationNamed
from kurt2rt.core.rla.lesson_history import DERIVED, LessonRecord
from kurt2rt.core.rla.rla import Origin
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.binding import require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries, fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.versions.editing import append_with_values
from kurt2rt.knowledge.versions.lesson_identity import first_command_id, lesson_keys


@dataclass(frozen=True, slots=True)
class MergeResult:
    """Lessons that a merge took from another knowledge file, or would take in a dry run."""

    merge_id: str
    """Id under which all of them can be undone."""
    lessons: int
    new_rlas: int
    left_out: tuple[LessonRecord, ...]
    """Those of the other file that did not find here what they found there."""
    stay_undone: int
    """Number of those that were undone here, and stay so."""


def merge(path: Path, other: Path, *, dry_run: bool = False) -> MergeResult:
    """Append the lessons that stand in `other` to `path`; durable on return, all or nothing.

    Lessons keep their teachers and dates. A robot may run on `other`, with `dry_run` also on `path`.

    Args:
        path: of the file that is changed.
        other: of the file that is read.
        dry_run: only tell what would come.

    Raises:
        KnowledgeError: a file cannot be used, or features or task differ.
    """
    with Journal.read_only(path) as journal:
        binding = journal.binding
    with Journal.read_only(other) as journal:
        require_compatible(journal.binding, binding, other, journal.has_lessons_at)
        entries, levels = journal.entries(), journal.binding.levels
        theirs = fold_entries(journal, entries, radius=math.inf)
    both = replace(binding, levels={**levels, **binding.levels})
    with Journal.read_only(path) if dry_run else Journal.open(path, both) as journal:
        merger = _Merger(fold_journal(journal, radius=math.inf))
        merger.bring(theirs, entries)
        if merger.entries and not dry_run:
            append_with_values(journal, merger.entries)
    return merger.result


class _Merger:
    """Collector of the lessons that come; applies them to the fold of this file."""

    def __init__(self, here: RlaSystem) -> None:
        self.entries: list[JournalEntry] = []
        self._left_out: list[LessonRecord] = []
        self._stay_undone = 0
        self._here = here
        self._there = RlaSystem(here.dimensions, math.inf)
        """The other file as the next lesson found it, without what was undone."""
        self._merge_id = f"merge-{secrets.token_hex(4)}"
        self._ids: dict[int, int] = {}
        """RLA id there -> id here."""

    @property
    def result(self) -> MergeResult:
        new_rlas = sum(isinstance(entry.event, RlaCreated) for entry in self.entries)
        return MergeResult(self._merge_id, len(self.entries), new_rlas, tuple(self._left_out), self._stay_undone)

    def bring(self, theirs: RlaSystem, entries: list[JournalEntry]) -> None:
        """Take over the lessons that stand in `theirs`, the fold of `entries`."""
        keys = lesson_keys(self._here)
        known = {keys[record.event.origin.command_id]: record for record in self._here.history.records}
        keys_there, stamps = lesson_keys(theirs), _stamps(entries)
        for record in theirs.history.records:
            command_id = record.event.origin.command_id
            if record.undone:
                continue
            if keys_there[command_id] in known:
                self._skip(record.event, known[keys_there[command_id]])
            else:
                self._bring(record, stamps[command_id])
            self._there.apply(record.event)

    def _skip(self, lesson: Lesson, known: LessonRecord) -> None:
        self._stay_undone += known.undone
        if isinstance(lesson, RlaCreated) and isinstance(known.event, RlaCreated):
            self._ids[lesson.rla.rla_id] = known.event.rla.rla_id

    def _bring(self, record: LessonRecord, stamp: str) -> None:
        lesson = self._translated(record.event)
        if lesson is None:
            self._left_out.append(record)
            return
        self._here.apply(lesson)
        self.entries.append(JournalEntry(lesson, stamp))

    def _translated(self, lesson: Lesson) -> Lesson | None:
        """Return a lesson with command id and RLA ids of this file; None if it does not find here what it found there.

        Credits of RLAs that are not here, or have another action here, are left out.
        """
        origin = self._origin(lesson.origin)
        match lesson:
            case RlaCreated(rla):
                here = self._ids[rla.rla_id] = self._here.next_id
                return RlaCreated(replace(rla, rla_id=here, origin=origin))
            case SituationNamed(name=name, level=level):
                here_at, there_at = (each.named_situations(level).get(name) for each in (self._here, self._there))
                return replace(lesson, origin=origin) if here_at == there_at else None
        if not self._is_as_there(lesson.rla_id):
            return None
        if isinstance(lesson, RlaRewarded):
            credits_ = (credit for credit in lesson.credits if self._is_as_there(credit.rla_id))
            kept = tuple(Credit(self._ids[rla_id], change) for rla_id, change in credits_)
            return replace(lesson, rla_id=self._ids[lesson.rla_id], credits=kept, origin=origin)
        return replace(lesson, rla_id=self._ids[lesson.rla_id], origin=origin)

    def _is_as_there(self, rla_id: int) -> bool:
        here, there = self._here.get(self._ids.get(rla_id, 0)), self._there.get(rla_id)
        return here is not None and there is not None and here.action == there.action

    def _origin(self, there: Origin) -> Origin:
        name = f"{self._merge_id}{DERIVED}{first_command_id(there.command_id)}"
        if self._here.history.get(name) is not None:  # two lessons there have this first id: one came there by a merge
            name = f"{self._merge_id}{DERIVED}{there.command_id}"
        return replace(there, command_id=name)


def _stamps(entries: list[JournalEntry]) -> Mapping[str, str]:
    return {entry.event.origin.command_id: entry.stamped_at for entry in entries}
