"""Knowledge file on a disk that may fail, in step with simulated time."""

import sqlite3
import time
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter, RetryDelays, utc_now
from kurt2rt.knowledge.knowledge_error import KnowledgeError, from_sqlite
from tests.faults.fault import Fault, FaultInjection

_LOOK_S = 0.0002
_PATIENCE_S = 30.0
"""Real time limit for the writer thread."""
_REFUSES = ("off", "intermittent", "garbage", "wrong")


class DiskOutOfStepError(RuntimeError):
    """Writer thread that exceeded its real time limit."""


class FaultyJournal(Journal):
    """Journal whose writes fail or block, called by the writer thread while simulated time goes on.

    off, intermittent: an error. stuck: a write blocks. garbage: the file is damaged. wrong: another file is in its
    place. slow: each write takes long. delayed: each write returns late.
    """

    injection: FaultInjection
    waits_until_s: float | None = None
    """Simulated end of a blocking write; None without one."""
    is_over = False
    """True at the end: writes neither fail nor block any more."""

    def append(self, entries: Sequence[JournalEntry], statistics: Statistics | None = None) -> list[Receipt]:
        """Write the entries under the fault. Raises KnowledgeError if the fault refuses the write."""
        now_s = self.injection.time.now_s()
        fault = None if self.is_over else self.injection.acting_on("disk")
        if fault is None:
            return super().append(entries, statistics)
        match fault.kind:
            case "off" | "intermittent":
                raise self._error("disk I/O error", sqlite3.SQLITE_IOERR)
            case "garbage":
                raise self._error("database disk image is malformed", sqlite3.SQLITE_CORRUPT)
            case "stuck":
                self._wait(fault.end_s)
            case "slow":
                self._wait(min(now_s + fault.delay_s, fault.end_s))
            case "delayed":
                receipts = super().append(entries, statistics)
                self._wait(min(now_s + fault.delay_s, fault.end_s))
                return receipts
            case "wrong":
                pass  # the file itself was taken away
        return super().append(entries, statistics)

    def _wait(self, until_s: float) -> None:
        self.waits_until_s = until_s
        while self.injection.time.now_s() < until_s and not self.is_over:
            time.sleep(_LOOK_S)
        self.waits_until_s = None

    def _error(self, text: str, code: int) -> KnowledgeError:
        error = sqlite3.OperationalError(text)
        error.sqlite_errorcode = code
        return from_sqlite(error, self.path)


class KnowledgeFile:
    """Knowledge file of one start of the program."""

    def __init__(self, path: Path, opened: OpenedKnowledge, injection: FaultInjection) -> None:
        """Open the file again, on a faulty disk. `opened`: its content, whose own journal is closed."""
        self.submitted: list[str] = []
        """Command ids of this start's lessons in order; the caller appends them."""
        self._acknowledged: list[str] = []
        self._path, self._injection = path, injection
        self._before = [entry.event.origin.command_id for entry in opened.entries]
        self._journal = FaultyJournal.open(path, opened.journal.binding)
        self._journal.injection = injection
        retry = RetryDelays(first_s=0.001, longest_s=0.001)
        self.writer = JournalWriter(self._journal, utc_now, retry, clock=injection.time.now_s)

    def prepare(self, fault: Fault) -> None:
        """Write what waits before a planned fault, and let the file be taken away if the fault says so."""
        self.keep_in_step(with_statistics=True)
        if fault.kind == "wrong":
            away, simulated = self._path.with_name("away"), self._injection.time
            simulated.at(fault.begin_s, lambda: _replace_by_another(self._path, away))
            simulated.at(fault.end_s, lambda: _bring_back(away, self._path))

    def keep_in_step(self, *, with_statistics: bool = False) -> None:
        """Wait in real time until the writer thread is idle at this simulated time.

        `with_statistics`: wait for statistics, too, which do not count as unwritten. Raises DiskOutOfStepError.
        """
        give_up_s = time.monotonic() + _PATIENCE_S
        while not self._in_step():
            if time.monotonic() > give_up_s:
                raise DiskOutOfStepError(f"{self.writer.unwritten} lessons wait; {self.writer.saving_error}")
            time.sleep(_LOOK_S)
        fails = self._injection.of("disk") is not None
        if with_statistics and not fails and not self.writer.flush(_PATIENCE_S):
            raise DiskOutOfStepError(f"statistics wait; {self.writer.saving_error}")

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        if acknowledgement.sequence is not None:
            self._acknowledged.append(acknowledgement.command_id)

    def close(self) -> Iterator[str]:
        """Write the rest, close the file and yield a complaint unless it holds every lesson, once, in order."""
        self._journal.is_over = True
        self.writer.close(_PATIENCE_S)
        for acknowledgement in self.writer.acknowledged():
            self.on_acknowledged(acknowledgement)
        with Journal.read_only(self._path) as journal:
            stored = [entry.event.origin.command_id for entry in journal.iter_entries()]
        if stored != list(chain(self._before, self.submitted)):
            yield f"{len(self._before)} and {len(self.submitted)} lessons were taught, the file holds {len(stored)}"
        if self._acknowledged != self.submitted:
            yield f"{len(self.submitted)} lessons were saved, {len(self._acknowledged)} were said to be"

    def _in_step(self) -> bool:
        if not self.writer.unwritten and self.writer.saving_error is None:
            return True
        now_s, waits_until_s = self._injection.time.now_s(), self._journal.waits_until_s
        if waits_until_s is not None:
            return now_s < waits_until_s
        fault = self._injection.of("disk")
        refuses = fault is not None and fault.kind in _REFUSES and fault.acts(now_s)
        return refuses and self.writer.saving_error is not None


def _replace_by_another(path: Path, away: Path) -> None:
    path.rename(away)
    path.write_bytes(b"")


def _bring_back(away: Path, path: Path) -> None:
    away.rename(path)
