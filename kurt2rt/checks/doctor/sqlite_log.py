"""Checks of SQLite and its write-ahead log, which the journal needs."""

import sqlite3
from contextlib import closing
from pathlib import Path

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode

LEAST_SQLITE = (3, 37, 0)
"""First version with STRICT tables."""


def check_sqlite(found: tuple[int, ...] = sqlite3.sqlite_version_info) -> CheckResult:
    """Check that Python's SQLite is new enough for the journal."""
    name = ".".join(map(str, found))
    if found < LEAST_SQLITE:
        least = ".".join(map(str, LEAST_SQLITE))
        return CheckResult(FindingCode.SQLITE_OLD, CheckStatus.MISSING, {"version": name, "least": least}, needed=True)
    return CheckResult(FindingCode.SQLITE, CheckStatus.OK, {"version": name}, needed=True)


def check_sqlite_log(folder: Path) -> CheckResult:
    """Check that a write-ahead log works in this folder; on most network disks it does not."""
    path = folder / "log.sqlite"
    try:
        with closing(_connect(path)) as writer, closing(_connect(path)) as reader:
            fault = log_fault(writer, reader)
    except sqlite3.Error as error:
        fault = str(error)
    if fault:
        return CheckResult(FindingCode.SQLITE_LOG_FAILS, CheckStatus.MISSING, {"fault": fault}, needed=True)
    return CheckResult(FindingCode.SQLITE_LOG, CheckStatus.OK, needed=True)


def _connect(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(path, timeout=0.2, isolation_level=None)


def log_fault(writer: sqlite3.Connection, reader: sqlite3.Connection) -> str:
    """Return the fault of a write during another program's read, in words; empty without a fault."""
    (mode,) = writer.execute("PRAGMA journal_mode = WAL").fetchone()
    if mode != "wal":
        return f"journal mode stays {mode}"
    writer.execute("PRAGMA synchronous = FULL")
    writer.execute("CREATE TABLE lesson (number INTEGER)")
    reader.execute("BEGIN")
    before = _lessons(reader)
    writer.execute("INSERT INTO lesson VALUES (1)")  # without a log this would wait for the reader, and fail
    during = _lessons(reader)
    reader.execute("COMMIT")
    seen = (before, during, _lessons(reader))
    return "" if seen == (0, 0, 1) else f"a reader saw {seen} lessons before, during and after, not (0, 0, 1)"


def _lessons(connection: sqlite3.Connection) -> int:
    (count,) = connection.execute("SELECT count(*) FROM lesson").fetchone()
    return int(count)
