"""Journal on a faulty disk, synchronised with simulated time."""

import sqlite3
import time
from collections.abc import Sequence
from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_knowledge, read_lessons
from kurt2rt.knowledge.journal.writer import JournalWriter, RetryDelays, utc_now
from kurt2rt.knowledge.knowledge_error import from_sqlite

_LOOK_S = 0.0002
_PATIENCE_S = 20.0
"""Real time limit for the writer thread."""


class DiskOutOfStepError(RuntimeError):
    """Writer thread that exceeded its real time limit."""


class FaultyJournal(Journal):
    """Journal whose writes fail or block, called by the writer thread while the scenario advances time."""

    disturbance: RigDisturbance | None = None
    """None: no fault."""
    simulated: SimulatedTime
    waits_until_s: float | None = None
    """Simulated end of a blocking write; None without one."""
    is_over = False
    """True at the end of the scenario: writes neither fail nor block any more."""

    def append(self, entries: Sequence[JournalEntry]) -> list[Receipt]:
        """Write the entries under the fault and return a receipt for each.

        Raises KnowledgeError if the fault refuses the write.
        """
        now_s = self.simulated.now_s()
        disturbance = self.disturbance
        if self.is_over or disturbance is None or not disturbance.acts(now_s):
            return super().append(entries)
        match disturbance.kind:
            case "off" | "intermittent":
                raise from_sqlite(_sqlite_error("disk I/O error", sqlite3.SQLITE_IOERR), self.path)
            case "garbage":
                raise from_sqlite(_sqlite_error("database disk image is malformed", sqlite3.SQLITE_CORRUPT), self.path)
            case "stuck":
                self._wait(disturbance.end_s)
            case "slow":
                self._wait(min(now_s + disturbance.delay_s, disturbance.end_s))
            case "delayed":
                receipts = super().append(entries)
                self._wait(min(now_s + disturbance.delay_s, disturbance.end_s))
                return receipts
            case "wrong":
                pass  # the file itself was taken away
        return super().append(entries)

    def _wait(self, until_s: float) -> None:
        self.waits_until_s = until_s
        while self.simulated.now_s() < until_s and not self.is_over:
            time.sleep(_LOOK_S)
        self.waits_until_s = None


class FailingDisk:
    """Knowledge file with its writer in step with simulated time (EventStore).

    off, intermittent: an error. stuck: a write blocks. garbage: the file is damaged. wrong: another file is in its
    place. slow: each write takes long. delayed: each write returns late.
    """

    def __init__(
        self,
        simulated: SimulatedTime,
        disturbance: RigDisturbance,
        path: Path,
        settings: RobotSettings,
        task: TaskSettings,
    ) -> None:
        self.submitted: list[str] = []
        """Command ids of the submitted lessons."""
        self.acknowledged: list[str] = []
        """Command ids of the lessons acknowledged as durable."""
        self._simulated = simulated
        self._disturbance = disturbance
        self._path, self._settings, self._task = path, settings, task
        with open_knowledge(path, settings, task) as new:
            binding = new.binding
        self._journal = FaultyJournal.open(path, binding)
        self._journal.disturbance = disturbance
        self._journal.simulated = simulated
        retry = RetryDelays(first_s=0.001, longest_s=0.001)
        self._writer = JournalWriter(self._journal, utc_now, retry, clock=simulated.now_s)
        if disturbance.kind == "wrong":
            schedule_file_swap(simulated, disturbance, path)

    @property
    def saving_error(self) -> str | None:
        """Error of the writer in one line; None if lessons can be saved."""
        return self._writer.saving_error

    def submit(self, event: TeachingEvent) -> None:
        """Queue a lesson for the writer thread. Raises KnowledgeError after `close`."""
        self.submitted.append(event.origin.command_id)
        self._writer.submit(event)

    def keep_in_step(self) -> None:
        """Wait in real time until the writer thread is idle at this simulated time.

        Raises DiskOutOfStepError.
        """
        give_up_s = time.monotonic() + _PATIENCE_S
        while not self._in_step():
            if time.monotonic() > give_up_s:
                raise DiskOutOfStepError(f"{self._writer.unwritten} lessons wait; {self._writer.saving_error}")
            time.sleep(_LOOK_S)
        self.acknowledged += [each.command_id for each in self._writer.acknowledged() if each.sequence is not None]

    def close(self) -> None:
        """Write the rest and close the file; idempotent. Raises KnowledgeError if lessons were not written."""
        self._journal.is_over = True
        self._writer.close()

    def lost_lessons(self) -> Complaint | None:
        """Compare the closed file with the lessons; None if it holds all of them, once, and in order.

        Raises KnowledgeError if the file cannot be read.
        """
        kept = [event.origin.command_id for event in read_lessons(self._path, self._settings, self._task)]
        if kept != self.submitted:
            taught, names = len(self.submitted), f": {kept}"
            return complaint(ComplaintCode.LESSONS_NOT_STORED, taught=taught, stored=len(kept), names=names)
        if self.acknowledged != self.submitted:
            saved, acknowledged = len(self.submitted), len(self.acknowledged)
            return complaint(ComplaintCode.LESSONS_NOT_ACKNOWLEDGED, saved=saved, acknowledged=acknowledged)
        return None

    def _in_step(self) -> bool:
        now_s = self._simulated.now_s()
        waits_until_s = self._journal.waits_until_s
        if waits_until_s is not None:
            return now_s < waits_until_s
        if self._writer.unwritten == 0:
            return self._writer.saving_error is None
        fails = self._disturbance.kind in ("off", "intermittent", "garbage", "wrong")
        return fails and self._disturbance.acts(now_s) and self._writer.saving_error is not None


def schedule_file_swap(simulated: SimulatedTime, disturbance: RigDisturbance, path: Path) -> None:
    """Schedule that another file replaces the one at `path` during the disturbance.

    `simulated`: time that the two changes happen in.
    """
    away = path.with_name(f"{path.name}.away")
    simulated.at(disturbance.begin_s, lambda: _swap_out(path, away))
    simulated.at(disturbance.end_s, lambda: _swap_back(away, path))


def _swap_out(path: Path, away: Path) -> None:
    path.rename(away)
    path.write_bytes(b"")


def _swap_back(away: Path, path: Path) -> None:
    away.rename(path)


def _sqlite_error(text: str, code: int) -> sqlite3.DatabaseError:
    error = sqlite3.OperationalError(text)
    error.sqlite_errorcode = code
    return error
