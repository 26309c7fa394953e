"""CAN bus within this process: `virtual:NAME`."""

import time
from collections.abc import Sequence
from queue import Empty, Full, SimpleQueue

import can
from can.interfaces.virtual import VirtualBus, channels_lock

from hal.frame import Frame

QUEUE_FRAMES = 4096
"""Frames that wait for a listener before the next sender fails."""

_OWN_QUEUE: type = SimpleQueue
"""Queue of an end of this class; other ends of python-can have another one."""


class InProcessBus(VirtualBus):
    """One end of python-can's in-process bus, with a queue that is written in C.

    Any other listener of python-can on the channel hears the same frames. The queue of its own end, the general
    `deepcopy` for every listener and the log call for every frame took a third of a simulated tick. So ends of this
    class share a `Frame`, and copy it only for a reader of single frames, who may change it.
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
        """Return the oldest frame, or None after `timeout` seconds; a `timeout` of None waits for one.

        Raises can.CanOperationError after shutdown.
        """
        if timeout == 0:
            frames = self.recv_all(1)
            frame = frames[0] if frames else None
        else:
            frame = super().recv(timeout)
        is_shared = type(frame) is Frame and not frame.timestamp
        return self._copy(frame, time.time()) if frame is not None and is_shared else frame

    def recv_all(self, most: int) -> list[can.Message]:
        """Return the waiting frames, oldest first, at most `most`; other ends share them, so they must not change.

        Raises can.CanOperationError after shutdown.
        """
        self._check_if_open()
        heard, get = self._heard, self.queue.get_nowait
        frames: list[can.Message] = []
        try:
            for _ in range(self.queue.qsize()):
                frame = get()
                # hal.bus_frame.is_heard, written out: a simulated tick drains twice.
                if (
                    heard is None
                    or (frame.arbitration_id in heard and not frame.is_extended_id)
                    or frame.is_error_frame
                ):
                    frames.append(frame)
                    if len(frames) == most:
                        break
        except Empty:  # another thread reads this end, too
            pass
        return frames

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Give a frame to all others; `timeout` (s) is unused. Raises can.CanOperationError if one is full."""
        self._check_if_open()
        all_took_it = True
        shares = type(msg) is Frame
        sent_at_s = time.time()
        for queue in self.channel:
            if queue is self.queue:
                continue
            full = queue.qsize() >= QUEUE_FRAMES  # a SimpleQueue has no limit of its own
            if not full:
                try:
                    queue.put_nowait(msg if shares and type(queue) is _OWN_QUEUE else self._copy(msg, sent_at_s))
                except Full:
                    full = True
            if full:
                all_took_it = False
        if not all_took_it:
            raise can.CanOperationError("a listener has too many frames waiting")

    def send_all(self, frames: Sequence[Frame]) -> None:
        """Send frames in order, as one call of `send` for each would, in a third of the time if there is one listener.

        Raises can.CanOperationError at the first frame for which a listener is full.
        """
        self._check_if_open()
        others = [queue for queue in self.channel if queue is not self.queue]
        if all(type(queue) is _OWN_QUEUE and queue.qsize() + len(frames) <= QUEUE_FRAMES for queue in others):
            for queue in others:
                put = queue.put_nowait
                for frame in frames:
                    put(frame)
            return
        for frame in frames:
            self.send(frame)

    def _copy(self, frame: can.Message, at_s: float) -> can.Message:
        """Return a copy that was received at a time in s of the wall clock."""
        copy = frame.__deepcopy__(None)
        copy.timestamp = at_s
        copy.channel = self.channel_id
        copy.is_rx = True
        return copy
