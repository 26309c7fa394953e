"""The journal: every teaching act, appended once, durable before it is acknowledged (design, Knowledge)."""

import os
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from kurt2rt.core.rla.rla import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.binding import KnowledgeBinding, require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt, StoredEntry, checksum, read_row
from kurt2rt.knowledge.journal.event_codec import decode_event, encode_event
from kurt2rt.knowledge.journal.statistics_tables import Change, changes, read_statistics
from kurt2rt.knowledge.knowledge_error import KnowledgeError, from_sqlite

_NOTE = "note "
"""Notes stand in table binding under keys such as `note branch of`; an earlier kurt2rt leaves them alone."""

_ROWS = "SELECT sequence, command_id, stamped_at, event, checksum FROM lesson ORDER BY sequence"


class Journal:
    """One knowledge file. Used by one thread at a time; all its errors are KnowledgeError."""

    def __init__(self, path: Path, connection: sqlite3.Connection, lock: BinaryIO | None = None) -> None:
        self.path = path
        self.binding = journal_file.read_binding(connection, path)
        self._connection = connection
        self._lock = lock
        self._files = journal_file.identities(path)
        self._written: Statistics | None = None
        """The statistics as they stand in the file, where this journal wrote them last: it is their only writer."""

    @classmethod
    def open(cls, path: Path, binding: KnowledgeBinding) -> Self:
        """Open the journal at `path` as its only writer, or begin one there. An error leaves every file as it was."""
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
        """Open to look at it, also while another process writes it. What is read then may be a lesson behind.

        Beside a file that had no log there is none after closing; a log that is there stays, a robot's or of one that
        was killed.
        """
        path = Path(os.path.realpath(path))
        journal_file.require_ours(path)
        return cls.in_writer_process(path)

    @classmethod
    def in_writer_process(cls, path: Path) -> Self:
        """Open to look at a file that this very process may be writing.

        Nothing but SQLite opens it here: closing a handle that SQLite does not know of would silently drop the locks
        of the writer, and another program could then take its log away.
        """
        path = Path(os.path.realpath(path))
        connection = journal_file.connect_to_look(path)
        try:
            return cls(path, connection)
        except BaseException:
            connection.close()
            raise

    def append(self, entries: Sequence[JournalEntry]) -> list[Receipt]:
        """Write lessons, all or none, durable on return; a known command id is not written twice. One receipt each."""
        with self._transaction():
            return [self._append(entry) for entry in entries]

    def append_and_checkpoint(self, entries: Sequence[JournalEntry], statistics: Statistics) -> list[Receipt]:
        """Write lessons, and what the statistics become by them, in one transaction."""
        differences = self._differences(statistics)
        with self._writing(statistics):
            receipts = [self._append(entry) for entry in entries]
            self._carry_out(differences)
        return receipts

    def _append(self, entry: JournalEntry) -> Receipt:
        text = encode_event(entry.event)
        command_id = entry.event.origin.command_id
        known = self._connection.execute(
            "SELECT sequence, stamped_at, event FROM lesson WHERE command_id = ?", (command_id,)
        ).fetchone()
        if known is not None:
            sequence, stamped_at, written = known
            return Receipt(command_id, sequence, stamped_at, new=False, agrees=_as_written_now(written) == text)
        cursor = self._connection.execute(
            "INSERT INTO lesson (command_id, stamped_at, event, checksum) VALUES (?, ?, ?, ?)",
            (command_id, entry.stamped_at, text, checksum(command_id, entry.stamped_at, text)),
        )
        if cursor.lastrowid is None:
            raise KnowledgeError(f"SQLite gave no row for command {command_id!r}", where=self.path, do="teach it again")
        return Receipt(command_id, cursor.lastrowid, entry.stamped_at, new=True, agrees=True)

    def _differences(self, statistics: Statistics) -> list[Change]:
        return changes(self._written or self.statistics(), statistics)

    @contextmanager
    def _writing(self, statistics: Statistics) -> Iterator[None]:
        """A transaction after which these statistics stand in the file; what stands there after an error is read."""
        self._written = None
        with self._transaction():
            yield
        self._written = statistics

    def _carry_out(self, differences: list[Change]) -> None:
        for statement, rows in differences:
            self._connection.executemany(statement, rows)

    def reconnect(self) -> None:
        """Let SQLite begin anew with the same files, as their only writer still; not used before this succeeds.

        Raises KnowledgeError.
        """
        self._require_in_place()
        with self._reading():
            self._connection.close()  # all its locks go with it
        # Whoever closes last merges the log and removes it.
        self._files = (self._files[0], journal_file.identities(self.path)[1])
        self._connection = journal_file.connect(self.path, "mode=rw")
        journal_file.make_durable(self._connection, self.path)
        self._files = (self._files[0], journal_file.identities(self.path)[1])

    def entries(self) -> list[StoredEntry]:
        """All lessons in the order of writing. Raises KnowledgeError that names file and row of a damaged one."""
        return list(self.iter_entries())

    def read_all(self) -> tuple[list[StoredEntry], Statistics]:
        """Lessons and statistics of one and the same moment, also while a robot writes both. Raises as `entries`."""
        with self._reading():
            self._connection.execute("BEGIN")
            try:
                return self.entries(), self.statistics()
            finally:
                if self._connection.in_transaction:
                    self._connection.execute("COMMIT")

    def iter_entries(self) -> Iterator[StoredEntry]:
        """The same one by one, all of one moment. Raises as `entries`."""
        with self._reading():
            for row in self._connection.execute(_ROWS):
                yield read_row(row, self._where(row))

    def has_lessons_at(self, level: str) -> bool:
        """Whether anything was ever taught at a level other than the basic one, or named there."""
        return journal_file.has_lessons(self._connection, self.path, level)

    def events(self) -> list[TeachingEvent]:
        """All teaching events in order: what an RLA system is the fold of."""
        return [entry.event for entry in self.entries()]

    def image(self) -> bytes:
        """All of the file as it stands at one moment, SQLite's log folded in, as bytes that are a file by themselves.

        Does not keep the one who writes it waiting.
        """
        with self._reading(), closing(sqlite3.connect(":memory:")) as copy:
            self._connection.backup(copy)
            return journal_file.without_log(copy.serialize())

    def checkpoint(self, statistics: Statistics) -> None:
        """Replace the statistics, in one transaction, in which nothing is written that did not change."""
        differences = self._differences(statistics)
        if differences:
            with self._writing(statistics):
                self._carry_out(differences)

    def statistics(self) -> Statistics:
        """The statistics of the last checkpoint."""
        with self._reading():
            return read_statistics(self._connection)

    def integrity_errors(self) -> list[str]:
        """What SQLite finds wrong with the file's pages, one line each: lessons may be missing without a trace."""
        try:
            lines = [line for (line,) in self._connection.execute("PRAGMA integrity_check")]
        except sqlite3.Error as error:
            return [str(from_sqlite(error, self.path))]
        return [f"{self.path}: {each}" for line in lines if line != "ok" for each in line.splitlines()]

    def check(self) -> list[str]:
        """Everything that is wrong with the file, one line each; empty when it is sound."""
        problems = self.integrity_errors()
        try:
            for expected, row in enumerate(self._connection.execute(_ROWS), start=1):
                if row[0] != expected:
                    problems.append(f"{self._where(row)}: stands where row {expected} should; keep the file")
                try:
                    read_row(row, self._where(row))
                except KnowledgeError as error:
                    problems.append(str(error))
        except sqlite3.Error as error:
            problems.append(str(from_sqlite(error, self.path)))
        return problems

    def note(self, name: str, text: str) -> None:
        """Write down something about the file as a whole, in the place of what that note said before."""
        with self._transaction():
            self._connection.execute("INSERT OR REPLACE INTO binding VALUES (?, ?)", (f"{_NOTE}{name}", text))

    def notes(self) -> dict[str, str]:
        """What was noted about the file as a whole, by name."""
        with self._reading():
            rows = self._connection.execute("SELECT key, value FROM binding ORDER BY key")
            return {key.removeprefix(_NOTE): value for key, value in rows if key.startswith(_NOTE)}

    def close(self) -> None:
        """Give the file back; the last one out merges SQLite's log into it."""
        try:
            with self._reading():
                self._connection.close()
        finally:
            if self._lock is not None:
                try:
                    self._lock.close()
                except OSError as error:
                    raise KnowledgeError(
                        f"its lock cannot be given back ({error})", where=self.path, do="it ends with this program"
                    ) from error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _where(self, row: tuple[int, str, str, str, int]) -> str:
        return f"{self.path}: row {row[0]}"

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        try:
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._connection.execute("COMMIT")
            except BaseException:
                if self._connection.in_transaction:  # SQLite itself may have rolled back already
                    self._connection.execute("ROLLBACK")
                raise
        except sqlite3.Error as error:
            raise from_sqlite(error, self.path) from error
        self._require_in_place()

    def _require_in_place(self) -> None:
        # SQLite goes on writing into a file that was deleted under it, and all would be gone at the end.
        if journal_file.identities(self.path) != self._files:
            raise KnowledgeError(
                "it or its log was moved, deleted or replaced while in use",
                where=self.path,
                do="put the same files back, or stop the robot and give a knowledge file",
            )

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise from_sqlite(error, self.path) from error


def _as_written_now(text: str) -> str | None:
    """An event's text as this version writes it; None for one that cannot be read."""
    try:
        return encode_event(decode_event(text, "row"))
    except KnowledgeError:
        return None
