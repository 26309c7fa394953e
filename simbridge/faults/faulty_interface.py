"""CAN interface with a faulty link per direction, in simulated time."""

import copy
from collections.abc import Callable

import can

from hal.can_interface import CanInterface
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.frame_link import FrameLink
from simbridge.faults.switchable_interface import InterfaceWrapper


class FaultyInterface(InterfaceWrapper):
    """Wrapper of an interface that adds SocketCAN's timestamps and confirmations, with a link per direction.

    Like the kernel, it stamps a frame that arrives from the bus before the inward link.
    """

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
        super().__init__(inner, time.now_s)
        self.receives_own_frames = receives_own_frames
        self._outward = outward
        self._inward = inward
        self._on_carried = on_carried

    def receive(self) -> None:
        """Move the frames that arrived on the bus to the inward link."""
        while True:
            frame = self._inner.recv(0)
            if frame is None:
                return
            frame.timestamp = self._now_s()
            self._inward.carry(frame, self._on_delivered)

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - nothing here waits
        """Return the oldest frame that the inward link delivered, or None without waiting `timeout` s."""
        return self._waiting.popleft() if self._waiting else None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """Send a frame over the outward link without waiting `timeout` s. Raises OSError, can.CanError."""
        self._outward.carry(msg, self._send_to_bus)

    def _send_to_bus(self, frame: can.Message) -> None:
        self._inner.send(frame, 0)
        if self.receives_own_frames:
            confirmed = copy.copy(frame)
            confirmed.timestamp = self._now_s()
            confirmed.is_rx = False
            self._waiting.append(confirmed)
        self._on_carried()
