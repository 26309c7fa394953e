import re
import resource
import sqlite3
import threading
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from itertools import count
from pathlib import Path

import pytest

from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter, RetryDelays, utc_now
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.knowledge.lessons import BINDING, STAMP, begun, created
from tests.knowledge.reading import events_in
from tests.knowledge.refusals import refused

SOON = RetryDelays(first_s=0.001, longest_s=0.004)


def writer_of(path: Path) -> JournalWriter:
    return JournalWriter(Journal.open(path, BINDING), now=lambda: STAMP, retry=SOON)


def settled(writer: JournalWriter) -> list[Acknowledgement]:
    """Return the acknowledgements of all that was submitted."""
    assert writer.flush(timeout_s=60)
    return writer.acknowledged()


def wait_for_error(writer: JournalWriter) -> str:
    """Return the error once there is one; the time limit of the test suite ends a wait in vain."""
    while writer.saving_error is None:
        writer.flush(timeout_s=0.001)
    return writer.saving_error


def test_acknowledged_durable_lessons_come_in_order(path: Path) -> None:
    lessons = [created(number) for number in range(1, 31)]
    with writer_of(path) as writer:
        for lesson in lessons:
            writer.submit(lesson)
        acknowledged = settled(writer)
        assert events_in(path) == lessons
        assert writer.unwritten == 0
        assert writer.saving_error is None

    assert acknowledged == [Acknowledgement(f"create-{number}", number, None, STAMP) for number in range(1, 31)]


class HangingJournal(Journal):
    """Its disk does not come back from a write before it is let go."""

    let_go: threading.Event

    def append(self, entries: Sequence[JournalEntry], statistics: Statistics | None = None) -> list[Receipt]:
        self.let_go.wait()
        return super().append(entries, statistics)


def test_error_hanging_write_is_told_until_it_ends(path: Path) -> None:
    journal = HangingJournal.open(path, BINDING)
    journal.let_go = threading.Event()
    now_s = 100.0
    with JournalWriter(journal, now=lambda: STAMP, retry=SOON, clock=lambda: now_s) as writer:
        now_s += 10.0  # with nothing to keep a disk may rest
        assert writer.saving_error is None
        writer.submit(created(1))
        now_s += 2.0
        writer.submit(created(2))
        now_s += 1.0
        assert writer.saving_error is None
        now_s += 0.1
        assert writer.saving_error is not None
        assert writer.saving_error.startswith(f"{path}: ")
        assert " 2 lessons" in writer.saving_error
        journal.let_go.set()
        assert [each.command_id for each in settled(writer)] == ["create-1", "create-2"]
        assert writer.saving_error is None
        writer.submit(created(3))
        assert writer.saving_error is None


def test_stamp_is_the_wall_clock_at_submit(path: Path) -> None:
    ticking = count(1)
    with JournalWriter(Journal.open(path, BINDING), now=lambda: f"stamp {next(ticking)}") as writer:
        writer.submit(created(1))
        writer.submit(created(2))
    with Journal.read_only(path) as journal:
        assert [entry.stamped_at for entry in journal.entries()] == ["stamp 1", "stamp 2"]
    assert utc_now().endswith("+00:00")


def test_submit_unwritable_lesson_does_not_delay_others(path: Path) -> None:
    broken = RlaCreated(replace(created(1).rla, condition=(float("nan"),)))
    with writer_of(path) as writer:
        writer.submit(broken)
        writer.submit(created(1, command_id="once more"))
        writer.submit(created(2, command_id="once more"))
        refused, written, clashing = settled(writer)

    assert refused.error is not None
    assert "finite" in refused.error
    assert (written.sequence, written.error) == (1, None)
    assert clashing.error is not None
    assert [each.stamped_at for each in (refused, written, clashing)] == ["", STAMP, ""]
    assert re.search(r"'once more'.*\b1\b", clashing.error)
    assert events_in(path) == [created(1, command_id="once more")]


def test_submit_full_disk_lessons_wait_in_order(path: Path) -> None:
    connection = journal_file.connect(begun(path), "mode=rw")
    journal_file.make_durable(connection, path)
    (pages,) = connection.execute("PRAGMA page_count").fetchone()
    connection.execute(f"PRAGMA max_page_count = {pages + 2}")  # SQLite's own full disk
    acknowledged = []
    with JournalWriter(Journal(path, connection), lambda: STAMP, SOON) as writer:
        for number in count(4):
            writer.submit(created(number))
            writer.flush(timeout_s=0.005)  # not all in one batch: some still fit
            acknowledged += writer.acknowledged()
            if writer.saving_error is not None:
                break
        assert writer.saving_error is not None
        assert writer.saving_error.startswith(f"{path}: {KnowledgeCode.DISK_FULL.text}; ")
        waiting = writer.unwritten
        assert len(events_in(path)) == number - waiting
        for later in range(number + 1, number + 51):
            writer.submit(created(later))
        assert not writer.flush(timeout_s=0.05)
        assert writer.acknowledged() == []
        assert writer.unwritten == waiting + 50
        assert len(events_in(path)) == number - waiting

        connection.execute("PRAGMA max_page_count = 100000")
        acknowledged += settled(writer)
        assert writer.saving_error is None

    assert [each.sequence for each in acknowledged] == list(range(4, later + 1))
    assert events_in(path) == [created(each) for each in range(1, later + 1)]


@contextmanager
def largest_file(size_bytes: int) -> Iterator[None]:
    """Limit the size of files of this process: larger writes fail with EFBIG, as on a broken disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_submit_failing_disk_lessons_wait_in_order(path: Path) -> None:
    with writer_of(path) as writer:
        writer.submit(created(1))
        assert len(settled(writer)) == 1
        log = journal_file.log_of(path)
        with largest_file(log.stat().st_size):
            for number in range(2, 20):
                writer.submit(created(number))
            error = wait_for_error(writer)
        acknowledged = settled(writer)
        assert writer.saving_error is None

    assert error.startswith(f"{path}: {KnowledgeCode.DISK_FAILS.text}; ")
    assert [each.sequence for each in acknowledged] == list(range(2, 20))
    assert events_in(path) == [created(number) for number in range(1, 20)]


def test_submit_locked_file_lessons_wait(path: Path) -> None:
    with writer_of(path) as writer, closing(sqlite3.connect(path, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        writer.submit(created(1))
        assert wait_for_error(writer).startswith(f"{path}: {KnowledgeCode.DATABASE_LOCKED.text}; ")
        other.execute("ROLLBACK")
        assert settled(writer) == [Acknowledgement("create-1", 1, None, STAMP)]


def test_acknowledged_moved_file_is_empty_until_it_is_back(path: Path) -> None:
    aside = path.with_name("aside.db")
    with writer_of(path) as writer:
        path.rename(aside)
        writer.submit(created(1))
        assert wait_for_error(writer) == str(KnowledgeError(KnowledgeCode.MOVED_IN_USE, where=path))
        assert writer.acknowledged() == []
        aside.rename(path)
        assert settled(writer) == [Acknowledgement("create-1", 1, None, STAMP)]
    assert events_in(path) == [created(1)]


def test_submit_statistics_only_the_newest_is_written(path: Path) -> None:
    with writer_of(path) as writer:
        for uses in range(1, 50):
            writer.submit_statistics(Statistics({1: uses}, {(1, 1): uses}))
    with Journal.read_only(path) as journal:
        assert journal.statistics() == Statistics({1: 49}, {(1, 1): 49})


def test_close_unwritten_lessons_are_counted(path: Path) -> None:
    writer = writer_of(path).start()
    with closing(sqlite3.connect(path, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        writer.submit(created(1))
        writer.submit(created(2))
        with refused(KnowledgeCode.LESSONS_NOT_WRITTEN, count=2):
            writer.close(timeout_s=0.5)
        assert writer.acknowledged() == []
    writer.close()
    with refused(KnowledgeCode.WRITER_CLOSED):
        writer.submit(created(3))


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_error_dead_thread_is_told(path: Path) -> None:
    def stopped_clock() -> str:
        raise OSError("no clock")

    writer = JournalWriter(Journal.open(path, BINDING), now=stopped_clock).start()
    writer.submit(created(1))
    assert "OSError('no clock')" in wait_for_error(writer)
    assert not writer.flush(timeout_s=60)
    with refused(KnowledgeCode.LESSONS_NOT_WRITTEN, count=1):
        writer.close()
    Journal.open(path, BINDING).close()


def test_failed_close_at_the_end_is_the_saving_error(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    close = Journal.close

    def close_badly(journal: Journal) -> None:
        close(journal)
        raise KnowledgeError(KnowledgeCode.LOCK_NOT_RELEASED, where=path, error="ENOLCK")

    monkeypatch.setattr(Journal, "close", close_badly)
    writer = writer_of(path)
    with refused(KnowledgeCode.LESSONS_NOT_WRITTEN, count=0), writer:
        writer.submit(created(1))
    assert writer.saving_error is not None
    assert "ENOLCK" in writer.saving_error
    assert [receipt.error for receipt in writer.acknowledged()] == [None]
