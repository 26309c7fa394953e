"""Rows of the journal: a lesson with its time, and the receipt for one that was written."""

import zlib
from dataclasses import dataclass

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.knowledge.journal.event_codec import decode_event
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError


@dataclass(frozen=True, slots=True)
class JournalEntry:
    """Lesson of the journal, with the time at which it was given."""

    event: TeachingEvent
    stamped_at: str
    """Wall clock, UTC, ISO 8601; empty if it is unknown."""


@dataclass(frozen=True, slots=True)
class Receipt:
    """Confirmation that a lesson is in the journal: its row, its time, and whether it is new."""

    command_id: str
    sequence: int
    stamped_at: str
    """Stamp of the row: when the lesson was first written, however often its command came."""
    new: bool
    """False: the command was written before, and was not written again."""
    agrees: bool
    """False: the row holds another lesson of the same command id, and this lesson stands nowhere."""


def checksum(command_id: str, stamped_at: str, text: str) -> int:
    """Return the CRC-32 of a row, which its reader compares.

    A worn flash disk may turn one digit into another, which SQLite does not notice.
    """
    return zlib.crc32("\n".join((command_id, stamped_at, text)).encode(errors="surrogateescape"))


def read_row(row: tuple[int, str, str, str, int], where: str) -> JournalEntry:
    """Return the entry in a row (sequence, command id, stamp, event, checksum).

    Raises:
        KnowledgeError: the row is damaged; its place is `where`.
    """
    _, command_id, stamped_at, text, written_checksum = row
    # A page of zeros has rows, too, with empty columns.
    if all(isinstance(part, str) for part in row[1:4]):
        event = decode_event(text, where)
        if checksum(command_id, stamped_at, text) == written_checksum and event.origin.command_id == command_id:
            return JournalEntry(event, stamped_at)
    raise KnowledgeError(KnowledgeCode.ROW_CHANGED, where=where)
