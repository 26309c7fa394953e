"""Journal of one knowledge file: each teaching event, appended once, durable before it is acknowledged."""

import os
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import BinaryIO, Self

from hal import points
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.binding import KnowledgeBinding, require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt, checksum, read_row
from kurt2rt.knowledge.journal.event_codec import encode_event
from kurt2rt.knowledge.journal.statistics_tables import TableChange, changes, read_statistics
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError, from_sqlite

_NOTE = "note "
"""Notes stand in table binding under keys such as `note imported from`."""

_ROWS = "SELECT sequence, command_id, stamped_at, event, checksum FROM lesson ORDER BY sequence"


class Journal:
    """One knowledge file: all lessons in order, in SQLite with a write-ahead log (event log).

    `append` returns once the lessons are durable; only then is a command acknowledged. Nothing is changed in place:
    an undo is another entry. Used by one thread at a time; all its errors are KnowledgeError.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection, lock: BinaryIO | None = None) -> None:
        self.path = path
        self.binding = journal_file.read_binding(connection, path)
        self._connection = connection
        self._lock = lock
        self._files = journal_file.identities(path)
        self._written: Statistics | None = None
        """Statistics as they stand in the file; None until this journal, their only writer, has written them."""

    @classmethod
    def open(cls, path: Path, binding: KnowledgeBinding) -> Self:
        """Open the journal at `path` as its only writer, or create it with the features and task of `binding`.

        Raises:
            KnowledgeError: the file is damaged, in use, or of other features or another task; no file was changed.
        """
        path = Path(os.path.realpath(path))
        if journal_file.is_there(path):
            journal_file.require_ours(path)
        lock = journal_file.lock_for_writing(path)
        try:
            if not journal_file.is_there(path):
                journal_file.create(path, binding)
            connection = journal_file.connect(path, "mode=rw")
            try:
                taught = journal_file.read_binding(connection, path)
                require_compatible(
                    taught, binding, path, lambda level: journal_file.has_lessons(connection, path, level)
                )
                journal_file.make_durable(connection, path)
                journal_file.complete(connection, path, binding.levels)
                return cls(path, connection, lock)
            except BaseException:
                connection.close()
                raise
        except BaseException:
            lock.close()
            raise

    @classmethod
    def read_only(cls, path: Path) -> Self:
        """Open for reading, also while another process writes the file; it may be read one lesson behind.

        A log next to the file stays if one is there, of a robot that runs or was killed; none is left otherwise.

        Raises:
            KnowledgeError: the file is missing, damaged or no knowledge file.
        """
        path = Path(os.path.realpath(path))
        journal_file.require_ours(path)
        return cls.in_writer_process(path)

    @classmethod
    def in_writer_process(cls, path: Path) -> Self:
        """Open for reading a file that this very process may be writing.

        Only SQLite opens it here: closing any other handle would silently drop the writer's locks, and another program
        could then remove its log.

        Raises:
            KnowledgeError: the file is missing, damaged or no knowledge file.
        """
        path = Path(os.path.realpath(path))
        connection = journal_file.connect_read_only(path)
        try:
            return cls(path, connection)
        except BaseException:
            connection.close()
            raise

    def append(self, entries: Sequence[JournalEntry], statistics: Statistics | None = None) -> list[Receipt]:
        """Write lessons, and the `statistics` after them, all or none, durable on return; return a receipt for each.

        A known command id is not written twice. Raises KnowledgeError if the disk does not take them; nothing is
        written then.
        """
        if statistics is None:
            with self._transaction():
                return [self._append(entry) for entry in entries]
        changed = self._changes_to(statistics)
        with self._writing(statistics):
            receipts = [self._append(entry) for entry in entries]
            self._execute(changed)
        return receipts

    def _append(self, entry: JournalEntry) -> Receipt:
        text = encode_event(entry.event)
        command_id = entry.event.origin.command_id
        known = self._connection.execute(
            "SELECT sequence, stamped_at, event FROM lesson WHERE command_id = ?", (command_id,)
        ).fetchone()
        if known is not None:
            sequence, stamped_at, written = known
            return Receipt(command_id, sequence, stamped_at, new=False, agrees=written == text)
        cursor = self._connection.execute(
            "INSERT INTO lesson (command_id, stamped_at, event, checksum) VALUES (?, ?, ?, ?)",
            (command_id, entry.stamped_at, text, checksum(command_id, entry.stamped_at, text)),
        )
        if cursor.lastrowid is None:
            raise KnowledgeError(KnowledgeCode.ROW_NOT_GIVEN, where=self.path, command_id=command_id)
        return Receipt(command_id, cursor.lastrowid, entry.stamped_at, new=True, agrees=True)

    def _changes_to(self, statistics: Statistics) -> list[TableChange]:
        return changes(self._written or self.statistics(), statistics)

    @contextmanager
    def _writing(self, statistics: Statistics) -> Iterator[None]:
        """Run a transaction after which these statistics stand in the file; after an error they are read again."""
        self._written = None
        with self._transaction():
            yield
        self._written = statistics

    def _execute(self, changed: list[TableChange]) -> None:
        for statement, rows in changed:
            self._connection.executemany(statement, rows)

    def reconnect(self) -> None:
        """Open a new SQLite connection to the same files, still as their only writer.

        Raises:
            KnowledgeError: SQLite cannot; the journal is not usable until a later call succeeds.
        """
        self._require_in_place()
        with self._reading():
            self._connection.close()  # all its locks go with it
        # The last connection that closes merges the log and removes it.
        self._files = (self._files[0], journal_file.identities(self.path)[1])
        self._connection = journal_file.connect(self.path, "mode=rw")
        journal_file.make_durable(self._connection, self.path)
        self._files = (self._files[0], journal_file.identities(self.path)[1])

    def entries(self) -> list[JournalEntry]:
        """Return all lessons in the order of writing. Raises KnowledgeError, naming file and row of a damaged one."""
        return list(self.iter_entries())

    def read_all(self) -> tuple[list[JournalEntry], Statistics]:
        """Return lessons and statistics of one moment, also while a robot writes both.

        Raises KnowledgeError, naming file and row of a damaged one.
        """
        with self._reading():
            self._connection.execute("BEGIN")
            try:
                return self.entries(), self.statistics()
            finally:
                if self._connection.in_transaction:
                    self._connection.execute("COMMIT")

    def iter_entries(self) -> Iterator[JournalEntry]:
        """Yield all lessons in the order of writing, of one moment.

        Raises KnowledgeError, naming file and row of a damaged one.
        """
        with self._reading():
            for row in self._connection.execute(_ROWS):
                yield read_row(row, self._where(row))

    def has_lessons_at(self, level: str) -> bool:
        """Return whether a lesson is about `level`, other than basic. Raises KnowledgeError."""
        return journal_file.has_lessons(self._connection, self.path, level)

    def events(self) -> list[TeachingEvent]:
        """Return all teaching events in the order of writing; they make an RLA system.

        Raises KnowledgeError, naming file and row of a damaged one.
        """
        return [entry.event for entry in self.entries()]

    def image(self) -> bytes:
        """Return the bytes of a knowledge file with all that this one holds at one moment, SQLite's log folded in.

        The writer does not wait for it. Raises KnowledgeError.
        """
        with self._reading(), closing(sqlite3.connect(":memory:")) as copy:
            self._connection.backup(copy)
            return journal_file.without_log(copy.serialize())

    def checkpoint(self, statistics: Statistics) -> None:
        """Replace the statistics in one transaction; write only rows that have changed. Raises KnowledgeError."""
        changed = self._changes_to(statistics)
        if changed:
            with self._writing(statistics):
                self._execute(changed)

    def statistics(self) -> Statistics:
        """Return the statistics of the last checkpoint; empty before the first. Raises KnowledgeError."""
        with self._reading():
            return read_statistics(self._connection)

    def integrity_errors(self) -> list[KnowledgeError]:
        """Return the errors that SQLite finds in the file's pages: lessons may be missing without a trace.

        Empty if the pages are intact. It raises nothing.
        """
        try:
            lines = [line for (line,) in self._connection.execute("PRAGMA integrity_check")]
        except sqlite3.Error as error:
            return [from_sqlite(error, self.path)]
        wrong = [each for line in lines if line != "ok" for each in line.splitlines()]
        return [KnowledgeError(KnowledgeCode.INTEGRITY, where=self.path, line=each) for each in wrong]

    def check(self) -> list[KnowledgeError]:
        """Return all errors in pages and rows; empty for an intact file. It raises nothing."""
        errors = self.integrity_errors()
        try:
            for expected, row in enumerate(self._connection.execute(_ROWS), start=1):
                if row[0] != expected:
                    where = self._where(row)
                    errors.append(KnowledgeError(KnowledgeCode.ROW_MISPLACED, where=where, expected=expected))
                try:
                    read_row(row, self._where(row))
                except KnowledgeError as error:
                    errors.append(error)
        except sqlite3.Error as error:
            errors.append(from_sqlite(error, self.path))
        return errors

    def note(self, name: str, text: str) -> None:
        """Write a note about the file as a whole; it replaces an earlier one of this name. Raises KnowledgeError."""
        with self._transaction():
            self._connection.execute("INSERT OR REPLACE INTO binding VALUES (?, ?)", (f"{_NOTE}{name}", text))

    def notes(self) -> dict[str, str]:
        """Return the notes about the file as a whole, by name. Raises KnowledgeError."""
        with self._reading():
            rows = self._connection.execute("SELECT key, value FROM binding ORDER BY key")
            return {key.removeprefix(_NOTE): value for key, value in rows if key.startswith(_NOTE)}

    def close(self) -> None:
        """Close the file and release its lock; the last connection merges the log into it. Raises KnowledgeError."""
        try:
            with self._reading():
                self._connection.close()
        finally:
            if self._lock is not None:
                try:
                    self._lock.close()
                except OSError as error:
                    raise KnowledgeError(KnowledgeCode.LOCK_NOT_RELEASED, where=self.path, error=error) from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _where(self, row: tuple[int, str, str, str, int]) -> str:
        return f"{self.path}: row {row[0]}"

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        try:
            points.fail("the file is locked", sqlite3.OperationalError, "database is locked")
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._connection.execute("COMMIT")
                points.fail("a durable commit fails", sqlite3.OperationalError, "disk I/O error")
            except BaseException:
                if self._connection.in_transaction:  # SQLite itself may have rolled back already
                    self._connection.execute("ROLLBACK")
                raise
        except sqlite3.Error as error:
            raise from_sqlite(error, self.path) from error
        self._require_in_place()

    def _require_in_place(self) -> None:
        # SQLite goes on writing into a deleted file, whose content is gone once it is closed.
        if journal_file.identities(self.path) != self._files:
            raise KnowledgeError(KnowledgeCode.MOVED_IN_USE, where=self.path)

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise from_sqlite(error, self.path) from error
