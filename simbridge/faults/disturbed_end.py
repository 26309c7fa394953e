"""CAN interface with a faulty link per direction, in simulated time."""

import copy
from collections import deque
from collections.abc import Callable

import can

from hal.can_interface import CanInterface
from simbridge.faults.event_time import EventScheduler
from simbridge.faults.frame_link import FrameLink


class FaultyInterface:
    """Wrapper of an interface that adds SocketCAN's timestamps and confirmations (hal.can_interface.CanInterface).

    Like the kernel, it stamps a frame that arrives from the bus before the inward link.
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
        """Wrap an interface; `on_carried` is called after the bus carried a frame of this interface."""
        self.receives_own_frames = receives_own_frames
        self._inner = inner
        self._time = time
        self._outward = outward
        self._inward = inward
        self._on_carried = on_carried
        self._waiting: deque[can.Message] = deque()

    def now_s(self) -> float | None:
        """Return the simulated time."""
        return self._time.now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Accept only these standard identifiers and error frames."""
        self._inner.set_id_filter(frame_ids)

    def receive(self) -> None:
        """Move the frames that arrived on the bus to the inward link."""
        while True:
            frame = self._inner.recv(0)
            if frame is None:
                return
            frame.timestamp = self._time.now_s()
            self._inward.carry(frame, self._on_delivered)

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - nothing here waits
        """Return the oldest frame or None without waiting `timeout` s."""
        return self._waiting.popleft() if self._waiting else None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """Send a frame over the outward link without waiting `timeout` s. Raises OSError, can.CanError."""
        self._outward.carry(msg, self._send_to_bus)

    def shutdown(self) -> None:
        """Close the wrapped interface."""
        self._inner.shutdown()

    def _on_delivered(self, frame: can.Message) -> None:
        if not frame.timestamp:  # made by the link
            frame.timestamp = self._time.now_s()
        self._waiting.append(frame)

    def _send_to_bus(self, frame: can.Message) -> None:
        self._inner.send(frame, 0)
        if self.receives_own_frames:
            confirmed = copy.copy(frame)
            confirmed.timestamp = self._time.now_s()
            confirmed.is_rx = False
            self._waiting.append(confirmed)
        self._on_carried()
