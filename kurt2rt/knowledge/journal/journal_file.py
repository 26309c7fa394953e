"""The journal's file: how it is born, recognised, locked against a second writer and connected to."""

import fcntl
import json
import os
import sqlite3
import stat
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import BinaryIO

from kurt2rt.core.rla.feature_set import LevelFeatures
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.journal_schema import (
    APPLICATION_ID,
    new_database,
    require_known_version,
    require_our_mark,
    require_our_schema,
)
from kurt2rt.knowledge.journal.statistics_tables import LATER_TABLES, has_table
from kurt2rt.knowledge.knowledge_error import KnowledgeError, from_sqlite
from kurt2rt.platform.durable_files import fsync_file, fsync_folder

BUSY_TIMEOUT_S = 0.2
"""How long SQLite itself waits for another program's lock; after that the writer says so and tries again."""
_CACHE_KIB = 128

_MAGIC = b"SQLite format 3\x00"
_HEADER_BYTES = 100
_APPLICATION_ID_AT = 68
_LOG_VERSIONS_AT = slice(18, 20)

_LEVEL = "level "
_LEVEL_KEYS = ("feature_hash", "feature_names")
"""A further level's features stand in table binding under keys such as `level critic feature_hash`."""


def lock_for_writing(path: Path) -> BinaryIO:
    """Hold the one writer's lock of a knowledge file until the result is closed, or the process is gone.

    Two writers would both give the next RLA the same id. The lock sits on a file beside: closing any second handle of
    the database itself would silently drop SQLite's own locks. Raises KnowledgeError.
    """
    try:
        lock = _lock_of(path).open("ab")
    except OSError as error:
        raise KnowledgeError(
            f"cannot be locked ({error})", where=path, do="give a path in a folder that exists and may be written"
        ) from error
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        lock.close()
        raise KnowledgeError(
            f"another kurt2rt is writing it ({error})", where=path, do="stop that one, or give another knowledge file"
        ) from error
    except OSError as error:
        lock.close()
        raise KnowledgeError(f"cannot be locked ({error})", where=path, do="give a path on a local disk") from error
    return lock


def require_no_writer(path: Path) -> None:
    """Raises KnowledgeError while somebody holds the writer's lock; puts none there, for a lock's file stays."""
    if is_there(_lock_of(path)):
        lock_for_writing(path).close()
    elif not os.access(path.parent, os.W_OK):
        raise KnowledgeError(
            "cannot be locked", where=path, do="give a path in a folder that exists and may be written"
        )


def create(path: Path, binding: KnowledgeBinding) -> None:
    """Put an empty journal at `path`, where nothing is, under the writer's lock. Raises KnowledgeError.

    It is born whole: built in memory, written beside, synced, then renamed, so that a crash never leaves half a file.
    """
    orphan = log_of(path)
    try:
        size = orphan.stat().st_size
    except FileNotFoundError:
        size = 0
    except OSError as error:
        raise KnowledgeError(f"cannot be looked at ({error})", where=orphan, do="look at the disk's health") from error
    if size > 0:  # SQLite would mix its lessons into the new file
        raise KnowledgeError(
            f"is gone, but its log {orphan.name} is still there and may hold lessons",
            where=path,
            do="put the file back beside it, or move the log away",
        )
    with closing(new_database()) as connection:
        meaning = {
            "feature_hash": binding.feature_hash,
            "feature_names": json.dumps(binding.feature_names),
            "system": binding.system,
            "robot": binding.robot,
            **_level_rows(binding.levels),
        }
        connection.executemany("INSERT INTO binding VALUES (?, ?)", meaning.items())
        image = connection.serialize()
    unborn = path.with_name(f".{path.name}.unborn")
    try:
        with unborn.open("wb") as file:
            file.write(image)
            file.flush()
            os.fsync(file.fileno())
        unborn.rename(path)
        fsync_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(
            f"cannot be created ({error})", where=path, do="give a path in a folder that may be written and has room"
        ) from error


def is_there(path: Path) -> bool:
    """Whether anything is at `path`; also true where that cannot be told, so that nothing is begun on top of it."""
    try:
        path.lstat()
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return True


def require_ours(path: Path) -> None:
    """Look at the header, before SQLite may touch the file. Raises KnowledgeError if it is no knowledge file."""
    what_to_do = "give the path of a kurt2rt knowledge file, or of a new one"
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise KnowledgeError("is a folder or device, not a file", where=path, do=what_to_do)
        # SQLite's log lies next to one name. A writer under another name does not see the lessons in it, and both
        # writers overwrite each other's pages.
        if status.st_nlink > 1:
            raise KnowledgeError(
                f"has {status.st_nlink} names (hard links), allowed is 1: lessons that a robot writes under "
                "one name are lost under the other",
                where=path,
                do="make a copy (cp), then remove the other names",
            )
        with path.open("rb") as file:
            header = file.read(_HEADER_BYTES)
    except OSError as error:
        raise KnowledgeError(f"cannot be read ({error})", where=path, do=what_to_do) from error
    if not header.startswith(_MAGIC):
        raise KnowledgeError("is not a knowledge file (no SQLite file)", where=path, do=what_to_do)
    if int.from_bytes(header[_APPLICATION_ID_AT : _APPLICATION_ID_AT + 4], "big") != APPLICATION_ID:
        raise KnowledgeError("is an SQLite file of another program", where=path, do=what_to_do)


def without_log(image: bytes) -> bytes:
    """The same database, marked as one that has no write-ahead log beside it (SQLite's file format, offset 18)."""
    header = bytearray(image[:_HEADER_BYTES])
    header[_LOG_VERSIONS_AT] = b"\x01\x01"
    return bytes(header) + image[_HEADER_BYTES:]


def connect(path: Path, options: str) -> sqlite3.Connection:
    """Connect to a knowledge file and compare its schema with ours; `options` are those of an SQLite URI.

    Raises KnowledgeError.
    """
    connection: sqlite3.Connection | None = None
    try:
        # One thread uses it at a time: the one that opens it reads the lessons, then the writer's thread takes over.
        connection = sqlite3.connect(
            f"{path.absolute().as_uri()}?{options}",
            uri=True,
            timeout=BUSY_TIMEOUT_S,
            isolation_level=None,
            check_same_thread=False,
        )
        # A damaged byte must not hide in which row it is: it is kept, and what reads the row refuses it.
        connection.text_factory = lambda text: text.decode(errors="surrogateescape")
        # Lessons are read once and appended to: SQLite's own 2 MB of cache would keep what nobody reads again.
        connection.execute(f"PRAGMA cache_size = {-_CACHE_KIB}")
        connection.execute("PRAGMA trusted_schema = OFF")  # a schema calls no function that has a side effect
        (version,) = connection.execute("PRAGMA user_version").fetchone()
    except sqlite3.Error as error:
        if connection is not None:
            connection.close()
        raise from_sqlite(error, path) from error
    try:
        require_our_mark(connection, path)
        require_known_version(version, path)
        require_our_schema(connection, path)
    except BaseException:
        connection.close()
        raise
    return connection


def connect_to_look(path: Path) -> sqlite3.Connection:
    """Connect to a file that is ours, to read alone. Raises KnowledgeError."""
    if is_there(log_of(path)):
        return connect(path, "mode=ro")
    if not (os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)):
        return connect(path, "mode=ro&immutable=1")  # SQLite cannot put a log there, and without a log needs none
    # Even to read, SQLite puts a log beside the file; who may not write there cannot take it away again. Whether a
    # robot has begun meanwhile only SQLite can tell: it removes the log when the last one closes.
    connection = connect(path, "mode=rw")
    try:
        connection.execute("PRAGMA query_only = ON")
    except sqlite3.Error as error:
        connection.close()
        raise from_sqlite(error, path) from error
    return connection


def _lock_of(path: Path) -> Path:
    return path.with_name(path.name + ".lock")


def log_of(path: Path) -> Path:
    """SQLite's write-ahead log beside the file: the newest lessons stand in it until it is merged."""
    return path.with_name(path.name + "-wal")


def identities(path: Path) -> tuple[tuple[int, int] | None, ...]:
    """Which files (device, inode) stand at the place of journal and log; None: none does. Raises KnowledgeError."""
    found: list[tuple[int, int] | None] = []
    for each in (path, log_of(path)):
        try:
            status = each.stat()
        except FileNotFoundError:
            found.append(None)
        except OSError as error:  # not knowing is not the same as knowing that it is gone
            raise KnowledgeError(
                f"cannot be looked at ({error})", where=each, do="look at the disk's health"
            ) from error
        else:
            found.append((status.st_dev, status.st_ino))
    return tuple(found)


def make_durable(connection: sqlite3.Connection, path: Path) -> None:
    """What stands there is on the disk, and every commit when it returns, from now on.

    Raises KnowledgeError if the file cannot do that.
    """
    try:
        (mode,) = connection.execute("PRAGMA journal_mode = WAL").fetchone()
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("BEGIN IMMEDIATE")  # finds a read-only or full disk now, not at the first lesson
        connection.execute("ROLLBACK")
        # What a program wrote that was killed before it was synced is shown by the kernel, and lost if the power goes:
        # what is found here counts as saved, so it is written to the disk anew.
        busy, in_log, merged = connection.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
        if busy or merged < in_log:  # somebody reads in it, and what he does not see yet stays in the log
            fsync_file(log_of(path))
            fsync_folder(path.parent)
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    except OSError as error:
        raise KnowledgeError(
            f"its log cannot be synced ({error})", where=path, do="look at the disk's health"
        ) from error
    if mode != "wal":
        raise KnowledgeError(
            f"its disk cannot hold an SQLite log (mode {mode})", where=path, do="give a path on a local disk"
        )


def complete(connection: sqlite3.Connection, path: Path, levels: Mapping[str, LevelFeatures]) -> None:
    """Add what a file lacks that was begun by an earlier kurt2rt, or without these levels. Raises KnowledgeError.

    Levels that it has with other features are bound anew: nothing must have been taught there.
    """
    known = read_binding(connection, path).levels
    missing = {level: features for level, features in levels.items() if known.get(level) != features}
    try:
        tables = [statement for name, statement in LATER_TABLES.items() if not has_table(connection, name)]
        if not missing and not tables:
            return
        connection.execute("BEGIN IMMEDIATE")
        try:
            for statement in tables:
                connection.execute(statement)
            connection.executemany("INSERT OR REPLACE INTO binding VALUES (?, ?)", _level_rows(missing).items())
            connection.execute("COMMIT")
        except BaseException:
            if connection.in_transaction:
                connection.execute("ROLLBACK")
            raise
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error


def has_lessons(connection: sqlite3.Connection, path: Path, level: str) -> bool:
    """Whether any lesson, of those that were undone too, is about a level other than basic. Raises KnowledgeError."""
    about = f'"level":{json.dumps(level)}'  # as events are written; within a name its quotes would be escaped
    try:
        found = connection.execute("SELECT 1 FROM lesson WHERE instr(event, ?) LIMIT 1", (about,)).fetchone()
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    return found is not None


def read_binding(connection: sqlite3.Connection, path: Path) -> KnowledgeBinding:
    """Read what the file is bound to. Raises KnowledgeError."""
    try:
        meaning: dict[str, str] = dict(connection.execute("SELECT key, value FROM binding"))
        names = json.loads(meaning["feature_names"])
        return KnowledgeBinding(
            meaning["feature_hash"], tuple(names), meaning["system"], meaning["robot"], _levels(meaning)
        )
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise KnowledgeError(
            f"table binding is damaged ({error!r})", where=path, do="keep the file, and go on with a backup copy"
        ) from error


def _level_rows(levels: Mapping[str, LevelFeatures]) -> dict[str, str]:
    rows = {}
    for level, features in levels.items():
        of_hash, of_names = (f"{_LEVEL}{level} {key}" for key in _LEVEL_KEYS)
        rows[of_hash], rows[of_names] = features.feature_hash, json.dumps(features.feature_names)
    return rows


def _levels(meaning: Mapping[str, str]) -> dict[str, LevelFeatures]:
    of_hash, of_names = (f" {key}" for key in _LEVEL_KEYS)
    levels = {}
    for key in sorted(meaning):
        if key.startswith(_LEVEL) and key.endswith(of_hash):
            level = key.removeprefix(_LEVEL).removesuffix(of_hash)
            names = json.loads(meaning[f"{_LEVEL}{level}{of_names}"])
            levels[level] = LevelFeatures(meaning[key], tuple(names))
    return levels
