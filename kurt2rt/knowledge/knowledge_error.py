"""Errors of knowledge files, and the advice for each of SQLite's error codes."""

import sqlite3
from pathlib import Path

from hal.errors import UserError


class KnowledgeError(UserError):
    """Knowledge cannot be read or written."""


class ReconnectRequiredError(KnowledgeError):
    """SQLite cannot recover on this connection, even when the disk does; open a new connection."""


_ADVICE = {
    sqlite3.SQLITE_PROTOCOL: "its locks are stuck; look at the disk's health, and start the robot program anew",
    sqlite3.SQLITE_FULL: "the disk is full; make room on it",
    sqlite3.SQLITE_IOERR: "the disk fails; look at its health and room, and keep a copy of the file",
    sqlite3.SQLITE_BUSY: "another program holds it locked; close that program",
    sqlite3.SQLITE_LOCKED: "another program holds it locked; close that program",
    sqlite3.SQLITE_READONLY: "it may not be written; give write permission for the file and its folder",
    sqlite3.SQLITE_PERM: "it may not be written; give write permission for the file and its folder",
    sqlite3.SQLITE_CANTOPEN: "it cannot be opened; look at permissions and room of its folder",
    sqlite3.SQLITE_CORRUPT: "the file is damaged; keep it, and go on with a backup copy",
    sqlite3.SQLITE_NOTADB: "the file is damaged; keep it, and go on with a backup copy",
}


def from_sqlite(error: sqlite3.Error, path: Path) -> KnowledgeError:
    """Return the error with file, advice and SQLite's own message, which a search engine finds."""
    code: int | None = getattr(error, "sqlite_errorcode", None)  # absent where Python itself raised the error
    primary = None if code is None else code & 0xFF  # the upper bits tell which read, write or sync it was
    advice = "SQLite refuses it; keep the file, and go on with a backup copy"
    if primary is not None:
        advice = _ADVICE.get(primary, advice)
    kind = ReconnectRequiredError if primary == sqlite3.SQLITE_PROTOCOL else KnowledgeError
    return kind(f"{advice} (SQLite: {error})", where=path)
