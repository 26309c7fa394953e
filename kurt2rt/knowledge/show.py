"""What `kurt2rt knowledge show` prints: every RLA with who taught it, when, instead of what, and how it is used."""

import math
from collections.abc import Iterable, Mapping

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from kurt2rt.knowledge.entry import StoredEntry
from kurt2rt.knowledge.fold import fold_entries
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.statistics import follow_ups
from kurt2rt.perception.definition import AVERAGED
from kurt2rt.rla.rla import ActionReplaced, LessonUndone, Rla, RlaDeleted, RlaRewarded, SessionBegun
from kurt2rt.rla.rla_system import Appraisal, RlaSystem

TICK_S = 0.01
"""The KURT2's cycle: a knowledge file counts in ticks and does not say how long they last."""

_TELLING_FEATURES = 3
_FOLLOW_UPS = 3


def render_knowledge(journal: Journal, limit: int | None = None, *, wide: bool = True) -> RenderableType:
    """Binding, summary and a table of the RLAs, oldest first, at most `limit` of them. Raises KnowledgeError.

    `wide` also shows each RLA's largest features and what follows it, for which 80 columns are too few.
    """
    # Lessons first: statistics read later may know more RLAs than are shown, never fewer.
    entries = journal.entries()
    system = fold_entries(journal, entries, radius=math.inf)
    rlas = system.rlas
    statistics = journal.statistics()
    taught = {entry.event.origin.command_id: entry for entry in entries}
    shares = follow_ups(statistics)
    named = any(rla.behaviour for rla in rlas)
    table = _empty_table(named=named, wide=wide)
    for rla in rlas[:limit]:
        entry = taught[rla.origin.command_id]
        cells: list[str | Text] = [
            str(rla.rla_id),
            *((_plain(rla.behaviour),) if named else ()),
            _plain(rla.action),
            _plain(entry.event.instead_of if isinstance(entry.event, ActionReplaced) else ""),
            _plain(_when_and_who(entry.stamped_at, rla.origin.teacher)),
            f"{rla.origin.phase.value}",
            str(rla.origin.tick),
            str(statistics.uses.get(rla.rla_id, 0)),
            _appraised(system.appraisal(rla.rla_id)),
        ]
        if wide:
            cells.append(_plain(_telling(rla, journal.binding.feature_names)))
            cells.append(_followed_by(shares.get(rla.rla_id, {})))
        table.add_row(*cells)
    hidden = len(rlas) - table.row_count
    parts: list[RenderableType] = [_plain(_bound_to(journal)), _plain(_summary(entries, system)), table]
    if hidden:
        parts.append(Text(f"and {hidden} more RLAs"))
    return Group(*parts)


def render_lessons(journal: Journal, limit: int | None = None) -> RenderableType:
    """All lessons, newest first, at most `limit` of them, with the ids that an undo takes. Raises KnowledgeError."""
    entries = journal.entries()
    records = fold_entries(journal, entries, radius=math.inf).lessons
    stamps = {entry.event.origin.command_id: entry.stamped_at for entry in entries}
    undone_by = {
        entry.event.lesson: entry.event.origin.teacher for entry in entries if isinstance(entry.event, LessonUndone)
    }
    table = Table(box=SIMPLE_HEAD)
    for heading in ("lesson", "id", "taught (UTC), by", "undone by"):
        table.add_column(heading, overflow="fold")
    for record in records[::-1][:limit]:
        origin = record.event.origin
        table.add_row(
            _plain(record.text),
            _plain(origin.command_id),
            _plain(_when_and_who(stamps[origin.command_id], origin.teacher)),
            _plain(undone_by.get(origin.command_id, "")),
        )
    hidden = len(records) - table.row_count
    return Group(table, Text(f"and {hidden} older lessons")) if hidden else table


def _empty_table(*, named: bool, wide: bool) -> Table:
    table = Table(box=SIMPLE_HEAD)
    behaviour = ("behaviour",) if named else ()
    for heading in ("RLA", *behaviour, "action", "instead of", "taught (UTC), by", "phase", "tick", "uses", "rewards"):
        right = heading in ("RLA", "phase", "tick", "uses", "rewards")
        table.add_column(heading, justify="right" if right else "left", overflow="fold", no_wrap=right)
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
    rewards = sum(isinstance(event, RlaRewarded) for event in events)
    if rewards:
        parts.append(f"{rewards} rewards")
    undos = [event for event in events if isinstance(event, LessonUndone)]
    if undos:
        parts.append(f"{len(undos)} undone by {_names(event.origin.teacher for event in undos)}")
    teachers = _names(record.event.origin.teacher for record in system.lessons)
    by = f" by {teachers}" if teachers else ""
    summary = (
        f"{len(system)} RLAs from {len(system.lessons)} lessons ({', '.join(parts)}){by}, "
        f"{entries[0].stamped_at} to {entries[-1].stamped_at}"
    )
    sessions = sum(isinstance(event, SessionBegun) for event in events)
    if sessions:
        minutes, seconds = divmod(round(system.teaching_ticks * TICK_S), 60)
        summary += f"; {sessions} sessions, {minutes} min {seconds} s of teaching"
    return summary


def _names(teachers: Iterable[str]) -> str:
    return ", ".join(sorted(set(teachers)))


def _when_and_who(stamped_at: str, teacher: str) -> str:
    return f"{stamped_at[:19].replace('T', ' ')}, {teacher}"


def _appraised(appraisal: Appraisal) -> str:
    """Such as +3 -1; nothing where nobody said anything."""
    return " ".join(
        f"{sign}{count}" for sign, count in (("+", appraisal.rewards), ("-", appraisal.punishments)) if count
    )


def _telling(rla: Rla, feature_names: tuple[str, ...]) -> str:
    """The recent features farthest from 0: a high count is a near obstacle, a wheel speed may be negative."""
    recent = [
        feature for feature in zip(feature_names, rla.condition, strict=True) if not feature[0].endswith(AVERAGED)
    ]
    features = sorted(recent, key=lambda feature: -abs(feature[1]))
    return ", ".join(f"{name} {value:.0f}" for name, value in features[:_TELLING_FEATURES])


def _followed_by(shares: Mapping[int, float]) -> str:
    return ", ".join(f"{rla_id} ({percent:.0f} %)" for rla_id, percent in list(shares.items())[:_FOLLOW_UPS])


def _plain(text: str) -> Text:
    """Names are shown as they are: neither rich's markup nor a terminal's escape sequences act."""
    return Text("".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text))
