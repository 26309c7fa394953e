"""Writer of the journal: a thread that makes lessons durable while the tick goes on."""

import math
import queue
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Self

from hal import points
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.event_codec import encode_event
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError, ReconnectRequiredError

HANGS_AFTER_S = 3.0
"""A disk hangs if lessons wait and none was written for so long."""


@dataclass(frozen=True, slots=True)
class Acknowledgement:
    """Result of a submitted lesson: durable at `sequence`, or never to be written because of `error`."""

    command_id: str
    sequence: int | None
    error: str | None
    stamped_at: str
    """Stamp of its row, UTC, ISO 8601; empty if there is an error."""


@dataclass(frozen=True, slots=True)
class RetryDelays:
    """Delays before the writer tries a failing disk again: doubled each time, up to the longest."""

    first_s: float = 0.1
    longest_s: float = 2.0


class _Flush:
    """Queue token: a thread waits until what came before it is durable, or never will be."""

    def __init__(self) -> None:
        self.durable = False
        self.settled = threading.Event()


class _Stop:
    """Queue token: the last item."""


def utc_now() -> str:
    """Return the wall clock as UTC in ISO 8601, to the millisecond."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class JournalWriter:
    """Owner of a journal, which writes lessons in the order of `submit`, drops none, and closes the journal.

    It is the `EventStore` of a robot (`kurt2rt/core/event_store.py`): a thread of its own writes, so no tick waits.
    On a failing disk the lessons wait and `saving_error` tells the cause: the robot must stand meanwhile. The writer
    tries again until it succeeds.
    """

    def __init__(
        self,
        journal: Journal,
        now: Callable[[], str],
        retry: RetryDelays | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`now` stamps the rows, `clock` (seconds) tells whether a write hangs."""
        self._failure: str | None = None
        self._journal = journal
        self._now = now
        self._clock = clock
        self._progress_at_s = -math.inf
        self._retry = retry or RetryDelays()
        # SimpleQueue.put never waits for the thread at the other end; a lock of our own could make the tick wait.
        self._queued: queue.SimpleQueue[TeachingEvent | Statistics | _Flush | _Stop] = queue.SimpleQueue()
        self._acknowledged: queue.SimpleQueue[Acknowledgement] = queue.SimpleQueue()
        self._accepting = True
        self._ended = False
        self._submitted = 0
        self._settled = 0
        self.last_write_s: float | None = None
        """Duration of the last write of lessons in seconds; None before the first."""
        # From here on, only the thread uses these.
        self._waiting: list[JournalEntry] = []
        self._statistics: Statistics | None = None
        self._flushes: list[_Flush] = []
        self._reconnects = False
        self._thread = threading.Thread(target=self._run, name="knowledge journal", daemon=True)
        self._started = False

    def start(self) -> Self:
        """Start the thread, once. Without it the caller calls `write_waiting`."""
        self._started = True
        self._thread.start()
        return self

    @property
    def saving_error(self) -> str | None:
        """Reason that lessons cannot be saved, in one line (where, what, what to do); None while they are durable."""
        if self._failure is None and self.unwritten and self._clock() - self._progress_at_s > HANGS_AFTER_S:
            return f"{self._journal.path}: the disk does not answer; {self.unwritten} lessons wait; look at its health"
        return self._failure

    @property
    def unwritten(self) -> int:
        """Number of lessons submitted and not yet acknowledged."""
        return self._submitted - self._settled

    @property
    def is_alive(self) -> bool:
        """Return whether the thread still runs."""
        return self._thread.is_alive()

    def submit(self, event: TeachingEvent) -> None:
        """Queue a lesson; never waits. `acknowledged` tells later that it is durable.

        Raises KnowledgeError after `close`.
        """
        self._require_open()
        if not self.unwritten:
            self._progress_at_s = self._clock()
        self._submitted += 1
        self._queued.put(event)

    def submit_statistics(self, statistics: Statistics) -> None:
        """Queue statistics; never waits. Only the newest that wait are written. Raises KnowledgeError after `close`."""
        self._require_open()
        self._queued.put(statistics)

    def acknowledged(self) -> list[Acknowledgement]:
        """Return the acknowledgements since the last call, in the order of `submit`; never waits."""
        settled: list[Acknowledgement] = []
        while True:
            try:
                settled.append(self._acknowledged.get_nowait())
            except queue.Empty:
                return settled

    def flush(self, timeout_s: float) -> bool:
        """Wait until everything queued before is durable; return False if it is not after `timeout_s`."""
        flush = _Flush()
        self._queued.put(flush)
        # Queued before the check: a writer that ends after the check still finds it in the queue.
        if not self._ended:
            flush.settled.wait(timeout_s)
        return flush.durable

    def close(self, timeout_s: float = 10.0) -> None:
        """Flush, then close the journal; waits at most `timeout_s` for the disk.

        Raises:
            KnowledgeError: lessons were not written; field `count` is their number, `reason` the cause.
        """
        if not self._accepting:
            return
        self._accepting = False
        if self._started:
            until_s = time.monotonic() + timeout_s
            self.flush(timeout_s)
            self._queued.put(_Stop())
            self._thread.join(max(0.0, until_s - time.monotonic()))
        else:
            self.write_waiting()
            self._end()
        if self.saving_error is not None or self._thread.is_alive():
            reason = self.saving_error or f"{self._journal.path}: the disk does not answer; look at its health"
            raise KnowledgeError(KnowledgeCode.LESSONS_NOT_WRITTEN, reason=reason, count=self.unwritten)

    def write_waiting(self) -> None:
        """Write what waits, once; a disk that fails is tried again by the next call. Only without the thread."""
        while not self._queued.empty():
            self._sort(self._queued.get())
        self._try()

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _require_open(self) -> None:
        if not self._accepting:
            raise KnowledgeError(KnowledgeCode.WRITER_CLOSED, where=self._journal.path)

    def _run(self) -> None:
        try:
            self._work()
        except BaseException as error:
            self._failure = f"{self._journal.path}: its writer ended by {error!r}; restart the robot program"
            raise
        finally:
            self._end()

    def _end(self) -> None:
        try:
            self._journal.close()
        except KnowledgeError as error:  # what was acknowledged is durable nevertheless
            self._failure = self._failure or str(error)
        self._ended = True
        while not self._queued.empty():
            item = self._queued.get()
            if isinstance(item, _Flush):
                self._flushes.append(item)
        for flush in self._flushes:
            flush.settled.set()

    def _work(self) -> None:
        pause_s = 0.0
        while True:
            stop = self._receive(pause_s)
            pause_s = 0.0 if self._try() else min(max(2 * pause_s, self._retry.first_s), self._retry.longest_s)
            if stop:
                return

    def _try(self) -> bool:
        """Write everything sorted, and return whether the disk took it; `saving_error` holds the error."""
        if points.happens("the disk is late"):
            return False
        try:
            if self._reconnects or points.happens("the file is opened again"):
                self._journal.reconnect()
                self._reconnects = False
            self._write()
        except KnowledgeError as error:
            self._failure = str(error)
            self._reconnects = self._reconnects or isinstance(error, ReconnectRequiredError)
            return False
        self._failure = None
        return True

    def _receive(self, pause_s: float) -> bool:
        """Sort everything queued and return whether to stop; wait for the next item, or the whole pause."""
        until_s = time.monotonic() + pause_s
        stop = pause_s == 0.0 and self._sort(self._queued.get())
        while not stop:
            try:
                stop = self._sort(self._queued.get(timeout=max(0.0, until_s - time.monotonic())))
            except queue.Empty:
                return False
        return True

    def _sort(self, item: TeachingEvent | Statistics | _Flush | _Stop) -> bool:
        """Put an item with what waits to be written; return whether it is the last one."""
        match item:
            case _Stop():
                return True
            case _Flush():
                self._flushes.append(item)
            case Statistics():
                self._statistics = item
            case _:
                self._receive_event(item)
        return False

    def _receive_event(self, event: TeachingEvent) -> None:
        try:
            encode_event(event)
        except KnowledgeError as error:  # another try would fail too, and delay all later lessons
            self._acknowledge(_refused(event.origin.command_id, str(error)))
        else:
            self._waiting.append(JournalEntry(event, self._now()))

    def _write(self) -> None:
        if self._waiting:
            begun_s = self._clock()
            receipts = self._journal.append(self._waiting)
            self.last_write_s = self._clock() - begun_s
            self._waiting = []
            for receipt in receipts:
                self._acknowledge(_acknowledgement(receipt))
        if self._statistics is not None and not points.happens("statistics wait"):
            self._journal.checkpoint(self._statistics)
            self._statistics = None
        for flush in self._flushes:
            flush.durable = True
            flush.settled.set()
        self._flushes = []

    def _acknowledge(self, acknowledgement: Acknowledgement) -> None:
        self._acknowledged.put(acknowledgement)
        self._progress_at_s = self._clock()
        self._settled += 1


def _acknowledgement(receipt: Receipt) -> Acknowledgement:
    if receipt.agrees:
        return Acknowledgement(receipt.command_id, receipt.sequence, None, receipt.stamped_at)
    return _refused(
        receipt.command_id,
        f"command {receipt.command_id!r}: another lesson of this id stands in row {receipt.sequence}; teach it again",
    )


def _refused(command_id: str, error: str) -> Acknowledgement:
    return Acknowledgement(command_id, None, error, stamped_at="")
