"""CAN bus within this process: `virtual:NAME`."""

import time
from queue import Empty, Full, SimpleQueue

import can
from can.interfaces.virtual import VirtualBus, channels_lock

QUEUE_FRAMES = 4096
"""Frames that wait for a listener before the next sender fails."""


class InProcessBus(VirtualBus):
    """One end of python-can's in-process bus, with a queue that is written in C.

    Any other listener of python-can on the channel hears the same frames. The queue of its own end, the general
    `deepcopy` for every listener and the log call for every frame took a third of a simulated tick.
    """

    receives_own_frames = False
    overruns = 0
    """Always 0: the sender fails instead."""

    def __init__(self, name: str) -> None:
        """Join the bus of that name in this process."""
        super().__init__(channel=name)
        self._heard: frozenset[int] | None = None
        waiting: SimpleQueue[can.Message] = SimpleQueue()
        with channels_lock:
            self.channel[self.channel.index(self.queue)] = waiting  # type: ignore[call-overload]  # same put and get
            self.queue = waiting  # type: ignore[assignment]

    def now_s(self) -> float | None:
        """Return None: waiting frames have just arrived, so a simulated run does not depend on the time of day."""
        return None

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Deliver only frames with these standard identifiers, and error frames."""
        self._heard = frame_ids

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Return the oldest frame, or None after `timeout` seconds. Raises can.CanOperationError after shutdown."""
        if timeout != 0:
            return super().recv(timeout)
        self._check_if_open()
        heard = self._heard
        try:
            while True:
                frame = self.queue.get_nowait()
                # hal.bus_frame.is_heard, written out: a simulated tick drains twice.
                if heard is None or (frame.arbitration_id in heard and not frame.is_extended_id):
                    return frame
                if frame.is_error_frame:
                    return frame
        except Empty:
            return None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Copy a frame to all others; `timeout` (s) is unused. Raises can.CanOperationError if one is full."""
        self._check_if_open()
        all_took_it = True
        sent_at_s = time.time()
        for queue in self.channel:
            if queue is self.queue:
                continue
            copy = msg.__deepcopy__(None)
            copy.timestamp = sent_at_s
            copy.channel = self.channel_id
            copy.is_rx = True
            full = queue.qsize() >= QUEUE_FRAMES  # a SimpleQueue has no limit of its own
            if not full:
                try:
                    queue.put_nowait(copy)
                except Full:
                    full = True
            if full:
                all_took_it = False
        if not all_took_it:
            raise can.CanOperationError("a listener has too many frames waiting")
