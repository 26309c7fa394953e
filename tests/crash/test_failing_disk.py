"""Each call that SQLite makes to the disk fails once, or for a while: no lesson is lost, none comes twice."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError, ReconnectRequiredError
from tests.crash.lessons_on_disk import require_kept
from tests.crash.restarts import LESSONS, LONGEST_S, SOON, a_lesson_at_a_time, with_patience
from tests.crash.watched_disk import Call, Failure, Fault, WatchedDisk, watched
from tests.knowledge.lessons import BINDING, STAMP, created, entry


def calls_of_a_lesson_at_a_time(path: Path) -> list[Call]:
    disk = WatchedDisk()
    with watched(disk):
        a_lesson_at_a_time(path, disk)
    return disk.calls


def fail_each_call(folder: Path, failure: Failure, lasts: int, every: int) -> Counter[Call]:
    """Let each call fail in turn, each on a file of its own; which ones failed."""
    failed: Counter[Call] = Counter()
    calls = len(calls_of_a_lesson_at_a_time(folder / "sound"))
    for number in range(1, calls + 1, every):
        path = folder / f"{number}"
        disk = WatchedDisk(Fault(number, failure, lasts))
        with watched(disk):
            acknowledged, refused = with_patience(path, disk)
        expected = [Acknowledgement(f"create-{lesson}", lesson, None, STAMP) for lesson in LESSONS]
        assert acknowledged[-len(LESSONS) :] == expected, (number, disk.failed, refused)
        for line in refused:
            assert line.startswith(f"{path}: "), line
            assert "\n" not in line
        with Journal.open(path, BINDING) as journal:
            assert journal.statistics() == Statistics({1: 8}, {(1, 2): 8})
        require_kept(path, told=len(LESSONS))
        failed.update(disk.failed[:1])
    return failed


@pytest.mark.parametrize("failure", Failure)
def test_a_call_that_fails_costs_no_lesson(tmp_path: Path, failure: Failure) -> None:
    assert fail_each_call(tmp_path, failure, lasts=1, every=9).total() > 20


@pytest.mark.deep
@pytest.mark.parametrize("lasts", [1, 2, 7, 40])
@pytest.mark.parametrize("failure", Failure)
def test_no_call_that_fails_costs_a_lesson_however_long_it_fails(tmp_path: Path, failure: Failure, lasts: int) -> None:
    failed = fail_each_call(tmp_path, failure, lasts, every=1)
    print(f"{failed.total()} calls: {dict(failed)}")
    assert set(failed) == set(Call)


class StuckJournal(Journal):
    """Journal with stuck locks until it reconnects; the first reconnection fails."""

    stuck = True
    tries = 0

    def append(self, entries: Sequence[JournalEntry], statistics: Statistics | None = None) -> list[Receipt]:
        if self.stuck:
            raise ReconnectRequiredError(KnowledgeCode.LOCKS_STUCK, where=self.path, error="")
        return super().append(entries, statistics)

    def reconnect(self) -> None:
        self.tries += 1
        super().reconnect()
        if self.tries < 3:
            raise KnowledgeError(KnowledgeCode.NOT_OPENED, where=self.path, error="")
        self.stuck = False


def test_writer_with_stuck_locks_reconnects_and_loses_nothing(tmp_path: Path) -> None:
    path = tmp_path / "knowledge"
    journal = StuckJournal.open(path, BINDING)
    journal.stuck = False
    journal.append([entry(1)])
    journal.stuck = True
    with JournalWriter(journal, now=lambda: STAMP, retry=SOON) as writer:
        writer.submit(created(2))
        writer.submit(created(3))
        assert writer.flush(LONGEST_S)
        assert writer.saving_error is None
        assert [each.sequence for each in writer.acknowledged()] == [2, 3]
    assert journal.tries == 3
    require_kept(path, told=3)
