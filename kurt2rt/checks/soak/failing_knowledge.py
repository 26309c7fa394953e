"""Knowledge file of a soak on a faulty disk, synchronised with simulated time."""

import time
from itertools import chain
from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.failing_disk import DiskOutOfStepError, FaultyJournal, schedule_file_swap
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import OpenedKnowledge, open_for_teaching
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter, RetryDelays, utc_now

_LOOK_S = 0.0002
_PATIENCE_S = 30.0
"""Real time limit for the writer thread."""
_FAIL = ("off", "intermittent", "garbage", "wrong")


def open_soak_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> OpenedKnowledge:
    """Return the file's content with its journal closed; SoakKnowledge opens a faulty one.

    Raises KnowledgeError if the file is damaged or does not fit robot or task, SettingsError.
    """
    opened = open_for_teaching(path, settings, task)
    opened.journal.close()
    return opened


class SoakKnowledge:
    """Knowledge file of one program start, closed by `close`."""

    def __init__(self, path: Path, opened: OpenedKnowledge, simulated: SimulatedTime) -> None:
        """Open the faulty journal. `opened`: result of `open_soak_knowledge` for `path`. Raises KnowledgeError."""
        self._path = path
        self._simulated = simulated
        self._disturbance: RigDisturbance | None = None
        # Not the entries themselves: the program that is tried here does not keep them, either.
        self._before = [entry.event.origin.command_id for entry in opened.entries]
        binding = opened.journal.binding
        self._journal = FaultyJournal.open(path, binding)
        self._journal.simulated = simulated
        retry = RetryDelays(first_s=0.001, longest_s=0.001)
        self.writer = JournalWriter(self._journal, utc_now, retry, clock=simulated.now_s)
        self.submitted: list[str] = []
        """Command ids of this start's lessons in order; the caller appends them."""
        self.acknowledged: list[str] = []
        """Command ids of the lessons acknowledged as durable."""

    @property
    def lessons(self) -> int:
        """Number of lessons in the file so far."""
        return len(self._before) + len(self.submitted)

    def disturb(self, disturbance: RigDisturbance) -> None:
        """Let the disk fail as the disturbance says, until `clear`.

        Raises DiskOutOfStepError if earlier lessons do not become durable.
        """
        self.keep_in_step(with_statistics=True)
        self._disturbance = self._journal.disturbance = disturbance
        if disturbance.kind == "wrong":
            schedule_file_swap(self._simulated, disturbance, self._path)

    def clear(self) -> None:
        """End the fault of the disk."""
        self._disturbance = self._journal.disturbance = None

    def keep_in_step(self, *, with_statistics: bool = False) -> None:
        """Wait in real time until the writer thread is idle at this simulated time.

        `with_statistics`: wait for statistics, too, which do not count as unwritten. Raises DiskOutOfStepError.
        """
        if self._disturbance is None and not self.writer.unwritten and not with_statistics:
            return
        give_up_s = time.monotonic() + _PATIENCE_S
        while not self._in_step():
            if time.monotonic() > give_up_s:
                raise DiskOutOfStepError(f"{self.writer.unwritten} lessons wait; {self.writer.saving_error}")
            time.sleep(_LOOK_S)
        if with_statistics and self._disturbance is None and not self.writer.flush(_PATIENCE_S):
            raise DiskOutOfStepError(f"statistics wait; {self.writer.saving_error}")

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        """Note the command id of a lesson that is durable; ignore a lesson that was refused."""
        if acknowledgement.sequence is not None:
            self.acknowledged.append(acknowledgement.command_id)

    def close(self) -> None:
        """Write the rest and close the file. Raises KnowledgeError if lessons were not written."""
        self._journal.is_over = True
        self.writer.close(_PATIENCE_S)
        for acknowledgement in self.writer.acknowledged():
            self.on_acknowledged(acknowledgement)

    def lost_lessons(self) -> Complaint | None:
        """Compare the closed file with the lessons; None if it holds all of them, once, and in order.

        Raises KnowledgeError if the file cannot be read.
        """
        # One by one, for all at once would be more than the program itself takes; whether they fit one another is
        # looked at when it is opened again.
        awaited = chain(self._before, self.submitted)
        with Journal.read_only(self._path) as journal:
            agree = [entry.event.origin.command_id == next(awaited, None) for entry in journal.iter_entries()]
        if not all(agree) or len(agree) != self.lessons:
            taught = len(self._before) + len(self.submitted)
            return complaint(ComplaintCode.LESSONS_NOT_STORED, taught=taught, stored=len(agree), names="")
        if self.acknowledged != self.submitted:
            saved, acknowledged = len(self.submitted), len(self.acknowledged)
            return complaint(ComplaintCode.LESSONS_NOT_ACKNOWLEDGED, saved=saved, acknowledged=acknowledged)
        return None

    def _in_step(self) -> bool:
        now_s, disturbance = self._simulated.now_s(), self._disturbance
        waits_until_s = self._journal.waits_until_s
        if waits_until_s is not None:
            return now_s < waits_until_s
        if not self.writer.unwritten and self.writer.saving_error is None:
            return True
        fails = disturbance is not None and disturbance.kind in _FAIL and disturbance.acts(now_s)
        return fails and self.writer.saving_error is not None
