"""Output of `kurt2rt knowledge show` and `lessons`: RLAs and lessons as tables and for JSON."""

import math
from collections.abc import Iterable
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    Appraised,
    LessonRedone,
    LessonUndone,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
)
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics, follow_ups
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries, read_content
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.level_tables import RlaRow, basic_table, level_table, named_table
from kurt2rt.knowledge.show.table_cells import printable, stamp_and_teacher
from kurt2rt.platform.text_table import TextTable

TICK_S = 0.01
"""Cycle of the KURT2: a knowledge file counts ticks and does not hold their duration."""


def render_knowledge(journal: Journal, limit: int | None = None, *, wide: bool = True) -> RenderableType:
    """Return binding, summary and a table of the RLAs of each level, oldest first, at most `limit` of each.

    `wide` adds each RLA's largest features and its successors, for which 80 columns are too few. Raises KnowledgeError.
    """
    entries, system, statistics = read_content(journal)
    parts: list[RenderableType] = [printable(_bound_to(journal)), printable(_summary(entries, system))]
    of_levels = _rlas_as_data(journal, entries, system, statistics)
    features = journal.binding.levels
    for level, rlas in of_levels.items():
        if level == BASIC:
            parts.append(basic_table(rlas[:limit], any_value=bool(_values(rlas)), wide=wide))
        elif rlas:
            parts.append(level_table(level, rlas[:limit], features[level]))
        more = len(rlas) - len(rlas[:limit])
        if more:
            parts.append(Text(f"and {more} more RLAs" if level == BASIC else f"and {more} more of the level {level}"))
        names = system.named_situations(level)
        if names and level != BASIC:
            parts.append(named_table(names, features[level]))
    return Group(*parts)


def render_lessons(journal: Journal, limit: int | None = None, taught_by: str | None = None) -> RenderableType:
    """Return a table of all lessons, newest first, at most `limit` of them, with their ids. Raises KnowledgeError.

    `taught_by`: only those of that teacher.
    """
    data = lessons_data(journal, limit, taught_by)
    table = TextTable("lesson", "id", "taught (UTC), by", "undone by")
    for each in data["lessons"]:
        taught = stamp_and_teacher(each["taught_at"], each["teacher"])
        table.add_row(printable(each["lesson"]), printable(each["id"]), taught, printable(each["undone_by"] or ""))
    return Group(table, Text(f"and {data['older']} older lessons")) if data["older"] else table


def knowledge_data(journal: Journal) -> dict[str, Any]:
    """Return binding, RLAs of all levels and named situations, for JSON. Raises KnowledgeError."""
    entries, system, statistics = read_content(journal)
    binding = journal.binding
    return {
        "file": str(journal.path),
        "task": binding.system,
        "robot": binding.robot,
        "definition": binding.feature_hash,
        "lessons": system.history.standing,
        "rlas": [rla for rlas in _rlas_as_data(journal, entries, system, statistics).values() for rla in rlas],
        "named": {
            level: {
                name: dict(zip(names, situation, strict=True))
                for name, situation in system.named_situations(level).items()
            }
            for level, names in _features(journal).items()
            if system.named_situations(level)
        },
    }


def _features(journal: Journal) -> dict[str, tuple[str, ...]]:
    """Return the names of the features of each level."""
    binding = journal.binding
    return {BASIC: binding.feature_names} | {level: each.feature_names for level, each in binding.levels.items()}


def _rlas_as_data(
    journal: Journal, entries: list[JournalEntry], system: RlaSystem, statistics: Statistics
) -> dict[str, list[RlaRow]]:
    """Return the RLAs of each level, oldest first."""
    taught = {entry.event.origin.command_id: entry for entry in entries}
    shares = follow_ups(statistics)
    return {
        level: [
            _rla_as_data(rla, taught[rla.origin.command_id], system, statistics)
            | {"followed_by_percent": shares.get(rla.rla_id, {})}
            | {"condition": dict(zip(names, rla.condition, strict=True))}
            for rla in system.rlas_at(level)
        ]
        for level, names in _features(journal).items()
    }


def _rla_as_data(rla: Rla, entry: JournalEntry, system: RlaSystem, statistics: Statistics) -> RlaRow:
    appraisal, event = system.appraisal(rla.rla_id), entry.event
    return {
        "rla": rla.rla_id,
        "level": rla.level,
        "behaviour": rla.behaviour,
        "action": rla.action,
        "asks": rla.is_withdrawn,
        "instead_of": event.instead_of if isinstance(event, ActionReplaced | ActionWithdrawn) else "",
        "teacher": rla.origin.teacher,
        "phase": rla.origin.phase.value,
        "tick": rla.origin.tick,
        "taught_at": entry.stamped_at,
        "lesson": rla.origin.command_id,
        "uses": statistics.uses.get(rla.rla_id, 0),
        "rewards": appraisal.rewards,
        "punishments": appraisal.punishments,
        "value": statistics.values.get(rla.rla_id),
    }


def _values(rlas: list[RlaRow]) -> list[float]:
    return [each["value"] for each in rlas if each["value"] is not None]


def lessons_data(journal: Journal, limit: int | None = None, taught_by: str | None = None) -> dict[str, Any]:
    """Return the lessons, newest first, at most `limit` of them, for JSON. Raises KnowledgeError.

    `taught_by`: only those of that teacher; None: all.
    """
    entries = journal.entries()
    lessons = fold_entries(journal, entries, radius=math.inf).history.records
    records = [record for record in lessons[::-1] if taught_by in (None, record.event.origin.teacher)]
    stamps = {entry.event.origin.command_id: entry.stamped_at for entry in entries}
    undone_by = {
        entry.event.lesson: entry.event.origin.teacher for entry in entries if isinstance(entry.event, LessonUndone)
    }
    return {
        "file": str(journal.path),
        "lessons": [
            {
                "id": record.event.origin.command_id,
                "lesson": record.text,
                "teacher": record.event.origin.teacher,
                "taught_at": stamps[record.event.origin.command_id],
                "undone_by": undone_by[record.event.origin.command_id] if record.undone else None,
            }
            for record in records[:limit]
        ],
        "older": len(records[limit:]) if limit is not None else 0,
    }


def _bound_to(journal: Journal) -> str:
    binding = journal.binding
    return (
        f"{journal.path}: knowledge of {binding.system}, first taught on {binding.robot}, "
        f"{len(binding.feature_names)} features, definition {binding.feature_hash}"
    )


def _summary(entries: list[JournalEntry], system: RlaSystem) -> str:
    if not entries:
        return "Nothing was taught yet."
    events = [entry.event for entry in entries]
    parts = [
        f"{sum(isinstance(event, ActionReplaced) for event in events)} corrections",
        f"{sum(isinstance(event, RlaDeleted) for event in events)} deletions",
    ]
    for kind, name in ((ActionWithdrawn, "withdrawals"), (RlaRewarded, "rewards"), (Appraised, "agreements")):
        count = sum(isinstance(event, kind) for event in events)
        if count:
            parts.append(f"{count} {name}")
    for change, name in ((LessonUndone, "undone"), (LessonRedone, "redone")):
        own = [event for event in events if isinstance(event, change)]
        if own:
            parts.append(f"{len(own)} {name} by {_names(event.origin.teacher for event in own)}")
    teachers = _names(record.event.origin.teacher for record in system.history.records)
    by = f" by {teachers}" if teachers else ""
    summary = (
        f"{_how_many(system)} from {system.history.standing} lessons ({', '.join(parts)}){by}, "
        f"{entries[0].stamped_at} to {entries[-1].stamped_at}"
    )
    sessions = sum(isinstance(event, SessionBegun) for event in events)
    if sessions:
        minutes, seconds = divmod(round(system.teaching_ticks * TICK_S), 60)
        summary += f"; {sessions} sessions, {minutes} min {seconds} s of teaching"
    return summary


def _names(teachers: Iterable[str]) -> str:
    return ", ".join(sorted(set(teachers)))


def _how_many(system: RlaSystem) -> str:
    asking = sum(rla.is_withdrawn for rla in system.rlas)
    ways, appraisals = len(system.rlas_at(MID)), len(system.rlas_at(CRITIC))
    return (
        f"{len(system)} RLAs"
        + (f", {asking} of which ask again," if asking else "")
        + (f" and {ways} mid-level RLAs" if ways else "")
        + (f" and {appraisals} appraisal RLAs" if appraisals else "")
    )
