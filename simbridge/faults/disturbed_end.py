"""One end of a bus with a way each for what goes out and what comes in, on the clock of simulated time."""

import copy
from collections import deque
from collections.abc import Callable

import can

from hal.can_interface import CanInterface
from simbridge.faults.event_time import EventScheduler
from simbridge.faults.way import FrameLink


class FaultyInterface:
    """Wrapper of a CanInterface that can behave as one of SocketCAN: stamps, and its own frames confirmed.

    Frames get their stamp when they come from the bus, before the way in: as the kernel does it.
    """

    overruns = 0

    def __init__(
        self,
        inner: CanInterface,
        time: EventScheduler,
        *,
        outward: FrameLink,
        inward: FrameLink,
        receives_own_frames: bool,
        on_carried: Callable[[], None],
    ) -> None:
        """`on_carried` is called when the bus has just carried a frame of this end."""
        self.receives_own_frames = receives_own_frames
        self._inner = inner
        self._time = time
        self._outward = outward
        self._inward = inward
        self._on_carried = on_carried
        self._waiting: deque[can.Message] = deque()

    def now_s(self) -> float | None:
        """Simulated time."""
        return self._time.now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Deliver only frames with these standard identifiers, and error frames."""
        self._inner.set_id_filter(frame_ids)

    def take_in(self) -> None:
        """Others have sent: what has come sets out on the way in."""
        while True:
            frame = self._inner.recv(0)
            if frame is None:
                return
            frame.timestamp = self._time.now_s()
            self._inward.carry(frame, self._arrive)

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - nothing here waits
        """The frame that waits longest."""
        return self._waiting.popleft() if self._waiting else None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """Put a frame on its way. Raises OSError, can.CanError."""
        self._outward.carry(msg, self._put_on_the_bus)

    def shutdown(self) -> None:
        """Give the bus back."""
        self._inner.shutdown()

    def _arrive(self, frame: can.Message) -> None:
        if not frame.timestamp:  # made on the way
            frame.timestamp = self._time.now_s()
        self._waiting.append(frame)

    def _put_on_the_bus(self, frame: can.Message) -> None:
        self._inner.send(frame, 0)
        if self.receives_own_frames:
            confirmed = copy.copy(frame)
            confirmed.timestamp = self._time.now_s()
            confirmed.is_rx = False
            self._waiting.append(confirmed)
        self._on_carried()
