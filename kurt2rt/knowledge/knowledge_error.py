"""Errors of knowledge: a code per condition with its fields, and the code for each of SQLite's errors."""

import sqlite3
from pathlib import Path

from config.errors import UserError
from kurt2rt.knowledge.knowledge_code import KnowledgeCode


class KnowledgeError(UserError):
    """Knowledge file or package that cannot be read or written; `code` names the condition."""

    def __init__(self, code: KnowledgeCode, *, where: object = "", **fields: object) -> None:
        """Fill the code's text with `fields`; `where` names the file, with the row if it is about one."""
        # Texts of exceptions only: the error crosses processes, and not every exception can.
        self.fields = {key: _plain(each) for key, each in fields.items()}
        super().__init__(code.text.format_map(self.fields), where=where, do=code.do.format_map(self.fields))
        self.code = code

    def __reduce__(self) -> tuple[object, ...]:
        """Return code, place and fields, from which another process builds the error."""
        return _rebuild, (type(self), self.code, self.where, self.fields)


class ReconnectRequiredError(KnowledgeError):
    """Error from which SQLite recovers on a new connection only, even when the disk does earlier."""


def _plain(field: object) -> object:
    """Return the text of an exception, of the operating system's without number and path; any other field as it is."""
    return (getattr(field, "strerror", None) or str(field)) if isinstance(field, BaseException) else field


def _rebuild(kind: type[KnowledgeError], code: KnowledgeCode, where: str, fields: dict[str, object]) -> KnowledgeError:
    return kind(code, where=where, **fields)


_CODES = {
    sqlite3.SQLITE_PROTOCOL: KnowledgeCode.LOCKS_STUCK,
    sqlite3.SQLITE_FULL: KnowledgeCode.DISK_FULL,
    sqlite3.SQLITE_IOERR: KnowledgeCode.DISK_FAILS,
    sqlite3.SQLITE_BUSY: KnowledgeCode.DATABASE_LOCKED,
    sqlite3.SQLITE_LOCKED: KnowledgeCode.DATABASE_LOCKED,
    sqlite3.SQLITE_READONLY: KnowledgeCode.READ_ONLY,
    sqlite3.SQLITE_PERM: KnowledgeCode.READ_ONLY,
    sqlite3.SQLITE_CANTOPEN: KnowledgeCode.NOT_OPENED,
    sqlite3.SQLITE_CORRUPT: KnowledgeCode.PAGES_DAMAGED,
    sqlite3.SQLITE_NOTADB: KnowledgeCode.PAGES_DAMAGED,
}


def from_sqlite(error: sqlite3.Error, path: Path) -> KnowledgeError:
    """Return the error with file, advice and SQLite's own message, which a search engine finds."""
    number: int | None = getattr(error, "sqlite_errorcode", None)  # absent if Python itself raised the error
    primary = None if number is None else number & 0xFF  # the upper bits tell which read, write or sync it was
    code = KnowledgeCode.SQLITE_REFUSES if primary is None else _CODES.get(primary, KnowledgeCode.SQLITE_REFUSES)
    kind = ReconnectRequiredError if code is KnowledgeCode.LOCKS_STUCK else KnowledgeError
    return kind(code, where=path, error=error)
