"""What `kurt2rt knowledge show` prints: every RLA with who taught it, when, instead of what, and how it is used."""

import math
from collections.abc import Mapping

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from kurt2rt.knowledge.entry import StoredEntry
from kurt2rt.knowledge.fold import fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.statistics import follow_ups
from kurt2rt.perception.definition import AVERAGED
from kurt2rt.rla.rla import ActionReplaced, Rla, RlaDeleted

_TELLING_FEATURES = 3
_FOLLOW_UPS = 3


def render_knowledge(journal: Journal, limit: int | None = None, *, wide: bool = True) -> RenderableType:
    """Binding, summary and a table of the RLAs, oldest first, at most `limit` of them. Raises KnowledgeError.

    `wide` also shows each RLA's largest features and what follows it, for which 80 columns are too few.
    """
    # Lessons first: statistics read later may know more RLAs than are shown, never fewer.
    entries = journal.entries()
    rlas = fold_journal(journal, radius=math.inf).rlas
    statistics = journal.statistics()
    taught = {entry.event.origin.command_id: entry for entry in entries}
    shares = follow_ups(statistics)
    table = _empty_table(wide=wide)
    for rla in rlas[:limit]:
        entry = taught[rla.origin.command_id]
        cells: list[str | Text] = [
            str(rla.rla_id),
            _plain(rla.action),
            _plain(entry.event.instead_of if isinstance(entry.event, ActionReplaced) else ""),
            _plain(f"{entry.stamped_at[:19].replace('T', ' ')}, {rla.origin.teacher}"),
            f"{rla.origin.phase.value}",
            str(rla.origin.tick),
            str(statistics.uses.get(rla.rla_id, 0)),
        ]
        if wide:
            cells.append(_plain(_telling(rla, journal.binding.feature_names)))
            cells.append(_followed_by(shares.get(rla.rla_id, {})))
        table.add_row(*cells)
    hidden = len(rlas) - table.row_count
    parts: list[RenderableType] = [_plain(_bound_to(journal)), _plain(_summary(entries, len(rlas))), table]
    if hidden:
        parts.append(Text(f"and {hidden} more RLAs"))
    return Group(*parts)


def _empty_table(*, wide: bool) -> Table:
    table = Table(box=SIMPLE_HEAD)
    for heading in ("RLA", "action", "instead of", "taught (UTC), by", "phase", "tick", "uses"):
        right = heading in ("RLA", "phase", "tick", "uses")
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


def _summary(entries: list[StoredEntry], living: int) -> str:
    if not entries:
        return "Nothing was taught yet."
    replaced = sum(isinstance(entry.event, ActionReplaced) for entry in entries)
    deleted = sum(isinstance(entry.event, RlaDeleted) for entry in entries)
    teachers = ", ".join(sorted({entry.event.origin.teacher for entry in entries}))
    return (
        f"{living} RLAs from {len(entries)} lessons ({replaced} corrections, {deleted} deletions) by {teachers}, "
        f"{entries[0].stamped_at} to {entries[-1].stamped_at}"
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
