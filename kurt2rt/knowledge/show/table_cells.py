"""Cells of the tables in which knowledge is shown."""

from rich.text import Text

from kurt2rt.core.rla.reward_counts import Appraisal
from kurt2rt.core.rla.rla import ActionReplaced, ActionWithdrawn, Rla
from kurt2rt.knowledge.journal.entry import StoredEntry

_ASKS = "asks again"


def plain(text: str) -> Text:
    """Names are shown as they are: neither rich's markup nor a terminal's escape sequences act."""
    return Text("".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text))


def stamp_and_teacher(stamped_at: str, teacher: str) -> Text:
    """To the second."""
    return plain(f"{stamped_at[:19].replace('T', ' ')}, {teacher}")


def answer(rla: Rla) -> Text:
    """Its action, or that it was withdrawn."""
    return plain(_ASKS if rla.is_withdrawn else rla.action)


def instead_of(entry: StoredEntry) -> Text:
    """The action before that of the entry that an RLA's present action is from; empty for its first one."""
    before = entry.event.instead_of if isinstance(entry.event, ActionReplaced | ActionWithdrawn) else ""
    return plain(before)


def appraised(appraisal: Appraisal) -> str:
    """Such as +3 -1; nothing where nobody said anything."""
    return " ".join(
        f"{sign}{count}" for sign, count in (("+", appraisal.rewards), ("-", appraisal.punishments)) if count
    )


def valued(value: float | None) -> str:
    """The value that rewards made; nothing where there is none."""
    return "" if value is None else f"{value:.2f}"
