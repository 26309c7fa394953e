"""One controller on the wire: what it has queued to send, what it heard, and its error state."""

from bisect import insort_left, insort_right
from collections import deque
from typing import NamedTuple

import can

from simbridge.wire.bits import arbitration_key, frame_bits
from simbridge.wire.error_counters import ErrorCounters, ErrorState
from simbridge.wire.error_frames import restarted_frame, state_frame
from simbridge.wire.settings import NodeSettings, SendingOrder

RX_QUEUE_FRAMES = 4096
"""Frames that wait for their reader; one that comes on top of them is lost to it."""


class Queued(NamedTuple):
    """A frame that wants to go out."""

    key: int
    frame: can.Message
    bits: int

    @staticmethod
    def of(frame: can.Message) -> "Queued":
        """A frame with what the wire needs to know of it."""
        return Queued(arbitration_key(frame), frame, frame_bits(frame))


class WireNode:
    """State of a controller; the wire decides what becomes of it. Times are nanoseconds of the wire."""

    def __init__(self, settings: NodeSettings, joined_ns: int) -> None:
        self.settings = settings
        self.counters = ErrorCounters()
        self.queue: list[Queued] = []
        self.waits_until_ns = joined_ns
        """No frame of its own begins before."""
        self.hears_from_ns = joined_ns
        """It takes no part in frames that began before."""
        self.restarts_at_ns: int | None = None
        """While bus-off, when it starts anew, if it does."""
        self.state = ErrorState.ACTIVE
        self.leaving = False
        """True when it is unplugged: it finishes what it has on the wire."""
        self._wanted_ids: frozenset[int] | None = None
        self.heard: deque[can.Message] = deque()
        self.overrun = 0
        """Frames that found its buffer full."""
        self._by_identifier = settings.order is not SendingOrder.FIFO
        self._newest_only = settings.order is SendingOrder.MAILBOX

    @property
    def off(self) -> bool:
        """Whether it withdrew from the wire."""
        return self.state is ErrorState.BUS_OFF

    def put(self, frame: can.Message) -> None:
        """Queue a frame. Raises can.CanOperationError when the queue is full. A node that is off drops it."""
        if self.off:
            # As Linux does: the interface has no carrier, and what is sent then is lost without a word.
            return
        queued = Queued.of(frame)
        older = self._waiting_with(queued.key) if self._newest_only else None
        if older is not None:
            self.queue[older] = queued
        elif len(self.queue) >= self.settings.queue_frames:
            raise can.CanOperationError("transmit queue is full")
        elif self._by_identifier:
            insort_right(self.queue, queued, key=_key)
        else:
            self.queue.append(queued)

    def put_back(self, queued: Queued) -> None:
        """Queue a frame that was destroyed, ahead of its equals."""
        if self.leaving or (self._newest_only and self._waiting_with(queued.key) is not None):
            return
        if self._by_identifier:
            insort_left(self.queue, queued, key=_key)
        else:
            self.queue.insert(0, queued)

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Keep only frames with these standard identifiers, and error frames, also of those that wait already."""
        self._wanted_ids = frame_ids
        self.heard = deque(frame for frame in self.heard if self._wants(frame))

    def hear(self, frame: can.Message, time_s: float, *, own: bool) -> None:
        """Take a copy of a carried frame, unless its reader does not want it."""
        if not self._wants(frame):
            return
        copy = frame.__deepcopy__(None)
        copy.is_rx = not own
        copy.timestamp = time_s
        self._keep(copy)

    def note_state(self, time_ns: int) -> None:
        """Tell the reader when the counters say another state than before; withdraw at bus-off."""
        state = self.counters.state
        if state is self.state:
            return
        self.state = state
        self._keep(state_frame(self.counters, time_ns / 1e9))
        if state is ErrorState.BUS_OFF:
            self.queue.clear()
            if self.settings.restart_s is not None:
                self.restarts_at_ns = time_ns + round(self.settings.restart_s * 1e9)

    def restart(self, time_ns: int, joins_ns: int) -> None:
        """Begin anew after bus-off; it takes part in the bus again from `joins_ns`."""
        self.counters = ErrorCounters()
        self.state = ErrorState.ACTIVE
        self.restarts_at_ns = None
        self.waits_until_ns = self.hears_from_ns = joins_ns
        self._keep(restarted_frame(self.counters, time_ns / 1e9))

    def _waiting_with(self, key: int) -> int | None:
        return next((at for at, queued in enumerate(self.queue) if queued.key == key), None)

    def _wants(self, frame: can.Message) -> bool:
        wanted = self._wanted_ids
        return wanted is None or (frame.arbitration_id in wanted and not frame.is_extended_id) or frame.is_error_frame

    def _keep(self, frame: can.Message) -> None:
        if len(self.heard) >= RX_QUEUE_FRAMES:
            self.overrun += 1
            return
        self.heard.append(frame)


def _key(queued: Queued) -> int:
    return queued.key
