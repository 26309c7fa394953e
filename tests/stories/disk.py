"""Knowledge file on a disk that may fail, written in line, as far as simulated time has gone."""

import math
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter
from kurt2rt.knowledge.knowledge_error import from_sqlite
from tests.stories.fault import FaultInjection
from tests.stories.table import Fault, Kind

_REFUSALS: dict[Kind, tuple[str, int]] = {
    "off": ("disk I/O error", sqlite3.SQLITE_IOERR),
    "intermittent": ("disk I/O error", sqlite3.SQLITE_IOERR),
    "garbage": ("database disk image is malformed", sqlite3.SQLITE_CORRUPT),
    "full": ("database or disk is full", sqlite3.SQLITE_FULL),
    "read_only": ("attempt to write a readonly database", sqlite3.SQLITE_READONLY),
}


_HANGS_AFTER_S = 3.0
"""Time after which a disk hangs, a second statement of the journal writer's."""
_STATISTICS_EVERY = 10
"""Calls of `write` from one that writes statistics to the next."""


class KilledError(BaseException):
    """End of the program by a signal that it does not see."""


class FaultyJournal(Journal):
    """Journal whose writes fail, or during which the program is killed."""

    injection: FaultInjection
    dies: Kind | None = None
    """Kill during the next write of lessons: before or after they are durable; None without one."""
    refused_at_s: float | None = None
    """Time of the first of the refusals since the last write; None without one."""
    is_sound = False
    """True at the end: no write fails any more."""

    def append(self, entries: Sequence[JournalEntry], statistics: Statistics | None = None) -> list[Receipt]:
        """Write the entries. Raises KnowledgeError if a fault refuses that, KilledError."""
        fault = None if self.is_sound else self.injection.acting_on("disk")
        if fault is not None and fault.kind in _REFUSALS:
            text, code = _REFUSALS[fault.kind]
            error = sqlite3.OperationalError(text)
            error.sqlite_errorcode = code
            self.refused_at_s = self.refused_at_s or self.injection.time.now_s()
            raise from_sqlite(error, self.path)
        if self.dies == "killed_before_commit":
            raise KilledError
        is_elsewhere = fault is not None and fault.kind == "wrong"
        self.refused_at_s = (self.refused_at_s or self.injection.time.now_s()) if is_elsewhere else None
        receipts = super().append(entries, statistics)
        if self.dies == "killed_after_commit":
            raise KilledError
        return receipts


class KnowledgeFile:
    """Knowledge file of one start of the program.

    stuck: a write blocks to the end of the fault. slow, delayed: each write takes long. wrong: another file is in its
    place. full, read_only and the others: an error.
    """

    def __init__(self, path: Path, opened: OpenedKnowledge, injection: FaultInjection, now: Callable[[], str]) -> None:
        """Open the file again, on a faulty disk. `opened`: its content, whose own journal is closed."""
        self.submitted: list[str] = []
        """Command ids of this start's lessons in order; the caller appends them."""
        self.acknowledged: list[str] = []
        self._path, self._injection, self._time = path, injection, injection.time
        self._before = [entry.event.origin.command_id for entry in opened.entries]
        self.journal = FaultyJournal.open(path, opened.journal.binding)
        self.journal.injection = injection
        self.writer = JournalWriter(self.journal, now, clock=injection.time.now_s)
        self._blocked_at_s = self._blocked_until_s = 0.0
        self._was_blocked = False
        self._calls = 0

    def write(self) -> None:
        """Write what waits, unless a write blocks at this simulated time. Raises KilledError."""
        now_s, fault = self._time.now_s(), self._injection.of("disk")
        if now_s < self._blocked_until_s:
            return
        waits = self.writer.unwritten and self.writer.saving_error is None and not self._was_blocked
        blocks = fault is not None and fault.kind in ("stuck", "slow", "delayed")
        if waits and blocks and (fault := self._injection.acting_on("disk")) is not None:
            until_s = fault.end_s if fault.kind == "stuck" else min(now_s + fault.delay_s, fault.end_s)
            self._blocked_at_s, self._blocked_until_s, self._was_blocked = now_s, until_s, True
            return
        self._was_blocked = False
        self._calls += 1
        if self.writer.unwritten or self._calls % _STATISTICS_EVERY == 0:
            self.writer.write_waiting()

    @property
    def must_stand_since_s(self) -> float:
        """Time from which on the robot must stand because the disk refuses a lesson, or hangs; or infinity."""
        if self._time.now_s() < self._blocked_until_s:
            return self._blocked_at_s + _HANGS_AFTER_S
        refused_at_s = self.journal.refused_at_s
        return math.inf if refused_at_s is None else refused_at_s

    def take_away(self, fault: Fault) -> None:
        """Write what waits, and put another file in the place of this one for as long as a planned fault lasts."""
        path, away = self._path, self._path.with_name("away")
        self._time.at(fault.begin_s, lambda: path.rename(away))
        self._time.at(fault.begin_s, lambda: path.write_bytes(b""))
        self._time.at(fault.end_s, lambda: away.rename(path))

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        if acknowledgement.sequence is not None:
            self.acknowledged.append(acknowledgement.command_id)

    def close(self, *, killed: bool = False) -> Iterator[str]:
        """Write the rest, unless the program was killed; yield a complaint unless the file holds every lesson, once.

        After a kill it holds what was acknowledged, and perhaps more of what was taught, in order.
        """
        self.journal.is_sound = True
        if killed:
            self.journal.close()
        else:
            self.writer.close()
            for acknowledgement in self.writer.acknowledged():
                self.on_acknowledged(acknowledgement)
        with Journal.read_only(self._path) as journal:
            stored = [entry.event.origin.command_id for entry in journal.iter_entries()]
        taught, saved = len(self.submitted), len(self.acknowledged)
        new = stored[len(self._before) :]
        least = saved if killed else taught
        if stored[: len(self._before)] != self._before or new != self.submitted[: len(new)] or len(new) < least:
            yield f"{len(self._before)} and {taught} lessons were taught, the file holds {len(stored)}"
        if self.acknowledged != self.submitted[: saved if killed else taught]:
            yield f"{taught} lessons were saved, {saved} were said to be"
