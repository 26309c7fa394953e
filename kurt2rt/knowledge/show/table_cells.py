"""Cells of the tables that show knowledge."""

from rich.text import Text

from kurt2rt.core.rla.events import ActionReplaced, ActionWithdrawn
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.statistics import Appraisal
from kurt2rt.knowledge.journal.entry import StoredEntry

_ASKS = "asks again"


def printable(text: str) -> Text:
    """Return the text without markup; characters that are not printable, as in escape sequences, are replaced."""
    return Text("".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text))


def stamp_and_teacher(stamped_at: str, teacher: str) -> Text:
    """Return a cell with a stamp, cut to the second, and the teacher."""
    return printable(f"{stamped_at[:19].replace('T', ' ')}, {teacher}")


def format_action(rla: Rla) -> Text:
    """Return the RLA's action for a cell, or that it was withdrawn."""
    return printable(_ASKS if rla.is_withdrawn else rla.action)


def replaced_action(entry: StoredEntry) -> Text:
    """Return the action that an RLA's present action replaced; empty for its first one. `entry` set the present one."""
    before = entry.event.instead_of if isinstance(entry.event, ActionReplaced | ActionWithdrawn) else ""
    return printable(before)


def format_rewards(appraisal: Appraisal) -> str:
    """Return counts of rewards such as +3 -1; empty if there are none."""
    return " ".join(
        f"{sign}{count}" for sign, count in (("+", appraisal.rewards), ("-", appraisal.punishments)) if count
    )


def format_value(value: float | None) -> str:
    """Return a value of rewards (dimensionless) with two decimals; empty if there is none."""
    return "" if value is None else f"{value:.2f}"
