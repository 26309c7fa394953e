"""File of the journal: creation, recognition, the lock against a second writer, and connections."""

import fcntl
import json
import os
import sqlite3
import stat
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import BinaryIO

from kurt2rt.core.rla.condition import LevelFeatures
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.journal_schema import (
    APPLICATION_ID,
    new_database,
    require_known_version,
    require_our_mark,
    require_our_schema,
)
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError, from_sqlite
from kurt2rt.platform.durable_files import fsync_file, fsync_folder

BUSY_TIMEOUT_S = 0.2
"""SQLite waits so long for another program's lock; then the writer reports it and tries again."""
_CACHE_KIB = 128

_MAGIC = b"SQLite format 3\x00"
_HEADER_BYTES = 100
_APPLICATION_ID_AT = 68
_LOG_VERSIONS_AT = slice(18, 20)

_LEVEL = "level "
_LEVEL_KEYS = ("feature_hash", "feature_names")
"""A further level's features stand in table binding under keys such as `level critic feature_hash`."""


def lock_for_writing(path: Path) -> BinaryIO:
    """Take the writer's lock of a knowledge file; it is held until the result is closed, or the process ends.

    Two writers would both give the next RLA the same id. The lock is on a file of its own: closing a second handle of
    the database itself would silently drop SQLite's own locks.

    Raises:
        KnowledgeError: another process holds it, or the folder or disk cannot hold a lock.
    """
    try:
        lock = _lock_of(path).open("ab")
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.FOLDER_NOT_LOCKABLE, where=path, error=error) from error
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        lock.close()
        raise KnowledgeError(KnowledgeCode.ANOTHER_WRITER, where=path, error=error) from error
    except OSError as error:
        lock.close()
        raise KnowledgeError(KnowledgeCode.DISK_WITHOUT_LOCKS, where=path, error=error) from error
    return lock


def require_no_writer(path: Path) -> None:
    """Raise KnowledgeError while a process holds the writer's lock; makes no lock file, because it would stay."""
    if is_there(_lock_of(path)):
        lock_for_writing(path).close()
    elif not os.access(path.parent, os.W_OK):
        raise KnowledgeError(KnowledgeCode.FOLDER_NOT_LOCKABLE, where=path, error="no write permission")


def create(path: Path, binding: KnowledgeBinding) -> None:
    """Make an empty journal at `path`, where no file is, under the writer's lock. Raises KnowledgeError.

    It is built in memory, written to a temporary file, synced and renamed: a crash never leaves half a file.
    """
    orphan = log_of(path)
    try:
        size = orphan.stat().st_size
    except FileNotFoundError:
        size = 0
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.STATUS_UNREADABLE, where=orphan, error=error) from error
    if size > 0:  # SQLite would mix its lessons into the new file
        raise KnowledgeError(KnowledgeCode.FILE_GONE, where=path, log=orphan.name)
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
    temporary = path.with_name(f".{path.name}.unborn")
    try:
        with temporary.open("wb") as file:
            file.write(image)
            file.flush()
            os.fsync(file.fileno())
        temporary.rename(path)
        fsync_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.NOT_CREATED, where=path, error=error) from error


def is_there(path: Path) -> bool:
    """Return whether anything is at `path`; True if that is unknown, so that no file is made in its place."""
    try:
        path.lstat()
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return True


def require_ours(path: Path) -> None:
    """Check status and header before SQLite opens the file. Raises KnowledgeError if it is no knowledge file."""
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise KnowledgeError(KnowledgeCode.NOT_A_FILE, where=path)
        # SQLite's log is next to one name. A writer under another name does not see the lessons in it, and both
        # writers overwrite each other's pages.
        if status.st_nlink > 1:
            raise KnowledgeError(KnowledgeCode.HARD_LINKS, where=path, names=status.st_nlink)
        with path.open("rb") as file:
            header = file.read(_HEADER_BYTES)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.UNREADABLE, where=path, error=error) from error
    if not header.startswith(_MAGIC):
        raise KnowledgeError(KnowledgeCode.NO_SQLITE_FILE, where=path)
    if int.from_bytes(header[_APPLICATION_ID_AT : _APPLICATION_ID_AT + 4], "big") != APPLICATION_ID:
        raise KnowledgeError(KnowledgeCode.OTHER_PROGRAM, where=path)


def without_log(image: bytes) -> bytes:
    """Return the bytes of a database, marked as one without a write-ahead log (SQLite's file format, offset 18)."""
    header = bytearray(image[:_HEADER_BYTES])
    header[_LOG_VERSIONS_AT] = b"\x01\x01"
    return bytes(header) + image[_HEADER_BYTES:]


def connect(path: Path, options: str) -> sqlite3.Connection:
    """Connect to a knowledge file and compare its schema with ours; `options` are those of an SQLite URI.

    Raises KnowledgeError.
    """
    connection: sqlite3.Connection | None = None
    try:
        # One thread uses it at a time: the opening thread reads the lessons, then the writer's thread takes over.
        connection = sqlite3.connect(
            f"{path.absolute().as_uri()}?{options}",
            uri=True,
            timeout=BUSY_TIMEOUT_S,
            isolation_level=None,
            check_same_thread=False,
        )
        # A damaged byte is kept as a surrogate: the check of the row then refuses it by number.
        connection.text_factory = lambda text: text.decode(errors="surrogateescape")
        # Lessons are read once, then appended to: SQLite's default cache of 2 MB would hold pages without use.
        connection.execute(f"PRAGMA cache_size = {-_CACHE_KIB}")
        connection.execute("PRAGMA trusted_schema = OFF")  # a schema may call no function with a side effect
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


def connect_read_only(path: Path) -> sqlite3.Connection:
    """Connect to a knowledge file for reading. Raises KnowledgeError."""
    if is_there(log_of(path)):
        return connect(path, "mode=ro")
    if not (os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)):
        return connect(path, "mode=ro&immutable=1")  # SQLite cannot put a log there, and without a log needs none
    # SQLite makes a log next to the file even to read. Only SQLite knows whether a robot has started meanwhile: it
    # removes the log when the last connection closes.
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
    """Return the path of SQLite's write-ahead log, which holds the newest lessons until it is merged."""
    return path.with_name(path.name + "-wal")


def identities(path: Path) -> tuple[tuple[int, int] | None, ...]:
    """Return (device, inode) of journal and log; None for a file that is not there. Raises KnowledgeError."""
    found: list[tuple[int, int] | None] = []
    for each in (path, log_of(path)):
        try:
            status = each.stat()
        except FileNotFoundError:
            found.append(None)
        except OSError as error:  # an unknown state does not mean that it is gone
            raise KnowledgeError(KnowledgeCode.STATUS_UNREADABLE, where=each, error=error) from error
        else:
            found.append((status.st_dev, status.st_ino))
    return tuple(found)


def make_durable(connection: sqlite3.Connection, path: Path) -> None:
    """Sync the content of the file to the disk, and have every later commit synced before it returns.

    Raises:
        KnowledgeError: the disk is read-only, full, or cannot hold a write-ahead log.
    """
    try:
        (mode,) = connection.execute("PRAGMA journal_mode = WAL").fetchone()
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("BEGIN IMMEDIATE")  # finds a read-only or full disk now, not at the first lesson
        connection.execute("ROLLBACK")
        # A killed program may have left pages that the kernel shows and no disk has. Lessons found here count as
        # saved, so they are synced again.
        busy, in_log, merged = connection.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
        if busy or merged < in_log:  # a reader of older pages keeps the rest in the log
            fsync_file(log_of(path))
            fsync_folder(path.parent)
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.LOG_NOT_SYNCED, where=path, error=error) from error
    if mode != "wal":
        raise KnowledgeError(KnowledgeCode.NO_WRITE_AHEAD_LOG, where=path, mode=mode)


def complete(connection: sqlite3.Connection, path: Path, levels: Mapping[str, LevelFeatures]) -> None:
    """Add the levels that the file lacks. Raises KnowledgeError.

    A level that the file has with other features is bound to these; no lesson may be about it.
    """
    known = read_binding(connection, path).levels
    missing = {level: features for level, features in levels.items() if known.get(level) != features}
    if not missing:
        return
    try:
        connection.execute("BEGIN IMMEDIATE")
        try:
            connection.executemany("INSERT OR REPLACE INTO binding VALUES (?, ?)", _level_rows(missing).items())
            connection.execute("COMMIT")
        except BaseException:
            if connection.in_transaction:
                connection.execute("ROLLBACK")
            raise
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error


def has_lessons(connection: sqlite3.Connection, path: Path, level: str) -> bool:
    """Return whether any lesson, undone ones included, is about `level`, other than basic. Raises KnowledgeError."""
    about = f'"level":{json.dumps(level)}'  # as events are written; within a name its quotes would be escaped
    try:
        found = connection.execute("SELECT 1 FROM lesson WHERE instr(event, ?) LIMIT 1", (about,)).fetchone()
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    return found is not None


def read_binding(connection: sqlite3.Connection, path: Path) -> KnowledgeBinding:
    """Return features and task that the file is bound to. Raises KnowledgeError."""
    try:
        meaning: dict[str, str] = dict(connection.execute("SELECT key, value FROM binding"))
        names = json.loads(meaning["feature_names"])
        return KnowledgeBinding(
            meaning["feature_hash"], tuple(names), meaning["system"], meaning["robot"], _levels(meaning)
        )
    except sqlite3.Error as error:
        raise from_sqlite(error, path) from error
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise KnowledgeError(KnowledgeCode.BINDING_DAMAGED, where=path, error=repr(error)) from error


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
