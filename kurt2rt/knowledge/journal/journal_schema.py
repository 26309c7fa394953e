"""Schema of a knowledge file: SQL texts, an empty database in memory, and the comparison of a file with them."""

import sqlite3
from collections.abc import Mapping
from contextlib import closing
from functools import lru_cache
from pathlib import Path

from kurt2rt.knowledge.journal.statistics_tables import STATISTICS_TABLES
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError, from_sqlite

APPLICATION_ID = 0x4B525432
"""'KRT2' in SQLite's header: tells a knowledge file from every other SQLite file."""

FORMAT_VERSION = 1

_SCHEMA = f"""
PRAGMA application_id = {APPLICATION_ID};
PRAGMA user_version = {FORMAT_VERSION};
CREATE TABLE binding (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE lesson (
    sequence INTEGER PRIMARY KEY,
    command_id TEXT NOT NULL UNIQUE,
    stamped_at TEXT NOT NULL,
    event TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
CREATE TRIGGER lesson_stays BEFORE DELETE ON lesson BEGIN SELECT RAISE(ABORT, 'lessons are never deleted'); END;
CREATE TRIGGER lesson_stands BEFORE UPDATE ON lesson BEGIN SELECT RAISE(ABORT, 'lessons are never changed'); END;
{STATISTICS_TABLES}"""


def require_our_mark(connection: sqlite3.Connection, path: Path) -> None:
    """Ask SQLite for the application id. Raises KnowledgeError if it is no knowledge file."""
    try:
        (application_id,) = connection.execute("PRAGMA application_id").fetchone()
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    if application_id != APPLICATION_ID:
        raise KnowledgeError(KnowledgeCode.OTHER_PROGRAM, where=path)


def require_known_version(version: int, path: Path) -> None:
    """Raise KnowledgeError for another format."""
    if version != FORMAT_VERSION:
        raise KnowledgeError(KnowledgeCode.OTHER_FORMAT, where=path, version=version, allowed=FORMAT_VERSION)


def require_our_schema(connection: sqlite3.Connection, path: Path) -> None:
    """Compare the file's schema with ours before any table is read. Raises KnowledgeError.

    A view in the place of a table may have endless rows, and a foreign trigger may change what a lesson does. A
    table of another name is left alone.
    """
    try:
        found = connection.execute("SELECT type, name, sql FROM sqlite_schema").fetchall()
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    ours = _our_schema()
    for kind, name, sql in found:
        text = _one_line(sql)
        if name in ours:
            foreign = ours[name] != (kind, text)
        elif kind == "index":
            foreign = bool(text)  # SQLite makes the index of a key by itself, without a text
        else:
            foreign = kind != "table" or not text.upper().startswith("CREATE TABLE ")
        if foreign:
            raise KnowledgeError(KnowledgeCode.FOREIGN_SCHEMA, where=path, kind=kind, name=name)


@lru_cache(maxsize=1)
def _our_schema() -> Mapping[str, tuple[str, str]]:
    """Kind and SQL text of each table and trigger that kurt2rt makes, by name."""
    with closing(new_database()) as connection:
        rows = connection.execute("SELECT type, name, sql FROM sqlite_schema WHERE sql IS NOT NULL").fetchall()
    return {name: (kind, _one_line(sql)) for kind, name, sql in rows}


def _one_line(sql: str | None) -> str:
    return " ".join((sql or "").split())


def new_database() -> sqlite3.Connection:
    """Return an empty knowledge file in memory, without binding. The caller closes the connection."""
    connection = sqlite3.connect(":memory:", isolation_level=None)
    connection.executescript(_SCHEMA)
    return connection
