"""Controller on the wire: transmit queue, receive queue and error state."""

from bisect import insort_left, insort_right
from collections import deque
from typing import NamedTuple

import can

from simbridge.wire.bits import arbitration_key, frame_bits
from simbridge.wire.error_counters import ErrorCounters, ErrorState
from simbridge.wire.error_frames import restarted_frame, state_frame
from simbridge.wire.settings import NodeSettings, SendingOrder

RX_QUEUE_FRAMES = 4096
"""Capacity of the receive queue; further frames are dropped."""


class Queued(NamedTuple):
    """Frame in the transmit queue."""

    key: int
    frame: can.Message
    bits: int

    @staticmethod
    def of(frame: can.Message) -> "Queued":
        """Return the queue's entry of a frame, with its arbitration key and its length in bits."""
        return Queued(arbitration_key(frame), frame, frame_bits(frame))


class WireNode:
    """State of a controller, driven by the wire. Times are nanoseconds of the wire."""

    def __init__(self, settings: NodeSettings, joined_ns: int) -> None:
        self.settings = settings
        self.counters = ErrorCounters()
        self.queue: list[Queued] = []
        self.waits_until_ns = joined_ns
        """Earliest start of an own frame."""
        self.receives_from_ns = joined_ns
        """Start of participation; earlier frames are neither received nor acknowledged."""
        self.restarts_at_ns: int | None = None
        """Time of the restart after bus-off; None without one."""
        self.state = ErrorState.ACTIVE
        self.unplugged = False
        """Whether the controller is unplugged and finishes its frame on the wire."""
        self._accepted_ids: frozenset[int] | None = None
        self.received: deque[can.Message] = deque()
        self.overruns = 0
        """Number of frames dropped because the receive queue was full."""
        self._by_identifier = settings.order is not SendingOrder.FIFO
        self._newest_only = settings.order is SendingOrder.MAILBOX

    @property
    def is_bus_off(self) -> bool:
        """Return whether the node left the bus after too many errors."""
        return self.state is ErrorState.BUS_OFF

    def enqueue(self, frame: can.Message) -> None:
        """Queue a frame; a bus-off node drops it. Raises can.CanOperationError if the queue is full."""
        if self.is_bus_off:
            # Linux does the same: an interface without carrier drops frames silently.
            return
        queued = Queued.of(frame)
        older = self._queued_index(queued.key) if self._newest_only else None
        if older is not None:
            self.queue[older] = queued
        elif len(self.queue) >= self.settings.queue_frames:
            raise can.CanOperationError("transmit queue is full")
        elif self._by_identifier:
            insort_right(self.queue, queued, key=_key)
        else:
            self.queue.append(queued)

    def requeue(self, queued: Queued) -> None:
        """Requeue a destroyed frame ahead of its equals."""
        if self.unplugged or (self._newest_only and self._queued_index(queued.key) is not None):
            return
        if self._by_identifier:
            insort_left(self.queue, queued, key=_key)
        else:
            self.queue.insert(0, queued)

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Accept only these standard identifiers and error frames; applies to queued frames too."""
        self._accepted_ids = frame_ids
        self.received = deque(frame for frame in self.received if self._accepts(frame))

    def deliver(self, frame: can.Message, time_s: float, *, own: bool) -> None:
        """Queue a copy of a carried frame for the reader if it passes the filter.

        `time_s`: its stamp in s. `own`: whether this node sent it.
        """
        if not self._accepts(frame):
            return
        copy = frame.__deepcopy__(None)
        copy.is_rx = not own
        copy.timestamp = time_s
        self._store(copy)

    def update_state(self, time_ns: int) -> None:
        """Report a changed error state to the reader; at bus-off clear the queue and schedule the restart.

        There is no restart if `restart_s` of the settings is None. `time_ns`: present time of the wire in ns.
        """
        state = self.counters.state
        if state is self.state:
            return
        self.state = state
        self._store(state_frame(self.counters, time_ns / 1e9))
        if state is ErrorState.BUS_OFF:
            self.queue.clear()
            if self.settings.restart_s is not None:
                self.restarts_at_ns = time_ns + round(self.settings.restart_s * 1e9)

    def restart(self, time_ns: int, joins_ns: int) -> None:
        """Restart after bus-off at `time_ns`; the node participates again from `joins_ns`, both in ns of the wire.

        The reader gets a frame that reports the restart.
        """
        self.counters = ErrorCounters()
        self.state = ErrorState.ACTIVE
        self.restarts_at_ns = None
        self.waits_until_ns = self.receives_from_ns = joins_ns
        self._store(restarted_frame(self.counters, time_ns / 1e9))

    def _queued_index(self, key: int) -> int | None:
        return next((at for at, queued in enumerate(self.queue) if queued.key == key), None)

    def _accepts(self, frame: can.Message) -> bool:
        wanted = self._accepted_ids
        return wanted is None or (frame.arbitration_id in wanted and not frame.is_extended_id) or frame.is_error_frame

    def _store(self, frame: can.Message) -> None:
        if len(self.received) >= RX_QUEUE_FRAMES:
            self.overruns += 1
            return
        self.received.append(frame)


def _key(queued: Queued) -> int:
    return queued.key
