"""Output of `kurt2rt knowledge show` and `lessons`: RLAs and lessons as tables and for JSON."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.core.perception.definition import AVERAGED
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
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics, follow_ups
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.fold import fold_entries, read_content
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.level_tables import level_table, mid_table, named_table
from kurt2rt.knowledge.show.table_cells import (
    format_action,
    format_rewards,
    format_value,
    printable,
    replaced_action,
    stamp_and_teacher,
)
from kurt2rt.platform.text_table import TextTable

TICK_S = 0.01
"""Cycle of the KURT2: a knowledge file counts ticks and does not hold their duration."""

_LARGEST_FEATURES = 3
_FOLLOW_UPS = 3


def render_knowledge(journal: Journal, limit: int | None = None, *, wide: bool = True) -> RenderableType:
    """Return binding, summary and a table of the RLAs, oldest first, at most `limit` of them. Raises KnowledgeError.

    `wide` adds each RLA's largest features and its successors, for which 80 columns are too few.
    """
    entries, system, statistics = read_content(journal)
    rlas = system.rlas
    any_value = any(rla.rla_id in statistics.values for rla in rlas)
    taught = {entry.event.origin.command_id: entry for entry in entries}
    shares = follow_ups(statistics)
    named = any(rla.behaviour for rla in rlas)
    table = _empty_table(named=named, any_value=any_value, wide=wide)
    for rla in rlas[:limit]:
        entry = taught[rla.origin.command_id]
        cells: list[str | Text] = [
            str(rla.rla_id),
            *((printable(rla.behaviour),) if named else ()),
            format_action(rla),
            replaced_action(entry),
            stamp_and_teacher(entry.stamped_at, rla.origin.teacher),
            f"{rla.origin.phase.value}",
            *((str(rla.origin.tick),) if wide or not any_value else ()),
            str(statistics.uses.get(rla.rla_id, 0)),
            format_rewards(system.appraisal(rla.rla_id)),
            *((format_value(statistics.values.get(rla.rla_id)),) if any_value else ()),
        ]
        if wide:
            cells.append(printable(_largest_features(rla, journal.binding.feature_names)))
            cells.append(_followed_by(shares.get(rla.rla_id, {})))
        table.add_row(*cells)
    hidden = len(rlas) - table.row_count
    parts: list[RenderableType] = [printable(_bound_to(journal)), printable(_summary(entries, system)), table]
    if hidden:
        parts.append(Text(f"and {hidden} more RLAs"))
    for level, features in journal.binding.levels.items():
        of_level = system.rlas_at(level)
        if of_level:
            if level == MID:
                parts.append(mid_table(of_level[:limit], features, taught, statistics.uses, shares))
            else:
                parts.append(level_table(level, of_level[:limit], features.feature_names, taught))
            more = len(of_level) - len(of_level[:limit])
            parts.extend([Text(f"and {more} more of the level {level}")] if more else [])
        names = system.named_situations(level)
        if names:
            parts.append(named_table(names, features))
    return Group(*parts)


def render_lessons(journal: Journal, limit: int | None = None, taught_by: str | None = None) -> RenderableType:
    """Return a table of all lessons, newest first, at most `limit` of them, with their ids. Raises KnowledgeError.

    `taught_by`: only those of that teacher.
    """
    records, stamps, undone_by = _read_lessons(journal, taught_by)
    table = TextTable("lesson", "id", "taught (UTC), by", "undone by")
    for record in records[:limit]:
        origin = record.event.origin
        table.add_row(
            printable(record.text),
            printable(origin.command_id),
            stamp_and_teacher(stamps[origin.command_id], origin.teacher),
            printable(undone_by[origin.command_id] if record.undone else ""),
        )
    hidden = len(records) - table.row_count
    return Group(table, Text(f"and {hidden} older lessons")) if hidden else table


def knowledge_data(journal: Journal) -> dict[str, Any]:
    """Return binding, RLAs of all levels and named situations, for JSON. Raises KnowledgeError."""
    entries, system, statistics = read_content(journal)
    taught = {entry.event.origin.command_id: entry for entry in entries}
    binding = journal.binding
    features = {BASIC: binding.feature_names} | {
        level: others.feature_names for level, others in binding.levels.items()
    }
    return {
        "file": str(journal.path),
        "task": binding.system,
        "robot": binding.robot,
        "definition": binding.feature_hash,
        "lessons": system.history.standing,
        "rlas": [
            _rla_as_data(rla, taught[rla.origin.command_id], system, statistics, features[rla.level])
            for level in features
            for rla in system.rlas_at(level)
        ],
        "named": {
            level: {
                name: dict(zip(names, situation, strict=True))
                for name, situation in system.named_situations(level).items()
            }
            for level, names in features.items()
            if system.named_situations(level)
        },
    }


def _rla_as_data(
    rla: Rla, entry: StoredEntry, system: RlaSystem, statistics: Statistics, names: tuple[str, ...]
) -> dict[str, Any]:
    appraisal = system.appraisal(rla.rla_id)
    return {
        "rla": rla.rla_id,
        "level": rla.level,
        "behaviour": rla.behaviour,
        "action": rla.action,
        "asks": rla.is_withdrawn,
        "instead_of": replaced_action(entry).plain,
        "teacher": rla.origin.teacher,
        "phase": rla.origin.phase.value,
        "tick": rla.origin.tick,
        "taught_at": entry.stamped_at,
        "lesson": rla.origin.command_id,
        "uses": statistics.uses.get(rla.rla_id, 0),
        "rewards": appraisal.rewards,
        "punishments": appraisal.punishments,
        "value": statistics.values.get(rla.rla_id),
        "followed_by_percent": follow_ups(statistics).get(rla.rla_id, {}),
        "condition": dict(zip(names, rla.condition, strict=True)),
    }


def lessons_data(journal: Journal, limit: int | None = None, taught_by: str | None = None) -> dict[str, Any]:
    """Return the lessons, newest first, at most `limit` of them, for JSON. Raises KnowledgeError.

    `taught_by`: only those of that teacher; None: all.
    """
    records, stamps, undone_by = _read_lessons(journal, taught_by)
    shown = records[:limit]
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
            for record in shown
        ],
        "older": len(records) - len(shown),
    }


def _read_lessons(journal: Journal, taught_by: str | None) -> tuple[list[LessonRecord], dict[str, str], dict[str, str]]:
    """Return the lessons, newest first, and by command id the stamps and the teachers of undos."""
    entries = journal.entries()
    lessons = fold_entries(journal, entries, radius=math.inf).history.records
    records = [record for record in lessons[::-1] if taught_by in (None, record.event.origin.teacher)]
    stamps = {entry.event.origin.command_id: entry.stamped_at for entry in entries}
    undone_by = {
        entry.event.lesson: entry.event.origin.teacher for entry in entries if isinstance(entry.event, LessonUndone)
    }
    return records, stamps, undone_by


def _empty_table(*, named: bool, any_value: bool, wide: bool) -> TextTable:
    table = TextTable()
    behaviour = ("behaviour",) if named else ()
    value = ("value",) if any_value else ()
    tick = ("tick",) if wide or not any_value else ()  # where there is no room for both
    numbers = ("phase", *tick, "uses", "rewards", *value)
    for heading in ("RLA", *behaviour, "action", "instead of", "taught (UTC), by", *numbers):
        table.add_column(heading, number=heading in ("RLA", *numbers))
    if wide:
        table.add_column("largest features")
        table.add_column("followed by")
    return table


def _bound_to(journal: Journal) -> str:
    binding = journal.binding
    return (
        f"{journal.path}: knowledge of {binding.system}, first taught on {binding.robot}, "
        f"{len(binding.feature_names)} features, definition {binding.feature_hash}"
    )


def _summary(entries: list[StoredEntry], system: RlaSystem) -> str:
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


def _largest_features(rla: Rla, feature_names: tuple[str, ...]) -> str:
    """Return the recent features farthest from 0: a high count is a near obstacle, a wheel speed may be negative."""
    recent = [
        feature for feature in zip(feature_names, rla.condition, strict=True) if not feature[0].endswith(AVERAGED)
    ]
    features = sorted(recent, key=lambda feature: -abs(feature[1]))
    return ", ".join(f"{name} {value:.0f}" for name, value in features[:_LARGEST_FEATURES])


def _followed_by(shares: Mapping[int, float]) -> str:
    return ", ".join(f"{rla_id} ({percent:.0f} %)" for rla_id, percent in list(shares.items())[:_FOLLOW_UPS])
