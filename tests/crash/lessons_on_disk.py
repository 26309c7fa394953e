"""A knowledge file that is taught on a watched disk, and what has to be true of it afterwards."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.journal import Journal
from tests.crash.operations import Told
from tests.crash.watched_disk import WatchedDisk
from tests.knowledge.lessons import BINDING, created, entry

PAGES_UNTIL_MERGED = 6
"""SQLite merges its log when it has so many pages, here soon."""


@contextmanager
def taught(path: Path) -> Iterator[Journal]:
    """Open the journal with a log that is checkpointed often."""
    with Journal.open(path, BINDING) as journal:
        journal._connection.execute(f"PRAGMA wal_autocheckpoint = {PAGES_UNTIL_MERGED}")
        yield journal


def teach(journal: Journal, disk: WatchedDisk, *lessons: int, statistics: bool = False) -> None:
    """Write lessons of these numbers, and say on the trace that they are saved."""
    entries = [entry(number) for number in lessons]
    if statistics:
        receipts = journal.append(entries, Statistics({1: lessons[-1]}, {(1, 2): lessons[-1]}))
    else:
        receipts = journal.append(entries)
    disk.note(Told(max(receipt.sequence for receipt in receipts)))


def a_day(path: Path, disk: WatchedDisk) -> None:
    """Teach the robot, switch it off, and teach it again."""
    with taught(path) as journal:
        teach(journal, disk, 1)
        teach(journal, disk, 2, 3, 4)
        teach(journal, disk, 5, 6, statistics=True)
        journal.checkpoint(Statistics({1: 9}, {(1, 2): 9}))
        teach(journal, disk, 7)
        teach(journal, disk, 8)
    with taught(path) as journal:
        teach(journal, disk, 9, 10)
        teach(journal, disk, 11, 12, 13, 14, statistics=True)


def require_kept(path: Path, told: int) -> None:
    """Assert that the file is sound, holds lessons 1 to `told` or more, in order and once, and takes another."""
    with Journal.open(path, BINDING) as journal:
        assert journal.check() == []
        events = journal.events()
        assert events == [created(number) for number in range(1, len(events) + 1)]
        assert len(events) >= told
        statistics = journal.statistics()
        assert statistics == Statistics() or statistics.uses[1] == statistics.transitions[1, 2]
        (receipt,) = journal.append([entry(len(events) + 1)])
        assert (receipt.sequence, receipt.new) == (len(events) + 1, True)
