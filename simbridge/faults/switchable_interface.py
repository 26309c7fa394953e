"""CAN interface with links that can fail and recover at any time."""

from collections import deque
from collections.abc import Callable

import can

from hal.bus import CONTROL_ID
from hal.can_interface import CanInterface
from hal.frame import Frame
from simbridge.faults.frame_link import FrameLink


class NumberedFrame(Frame):
    """Frame whose copies share a number."""

    __slots__ = ("number",)

    def __init__(self, frame_id: int, payload: bytes, number: int) -> None:
        super().__init__(frame_id, payload)
        self.number = number

    def __deepcopy__(self, memo: dict[int, object] | None) -> "NumberedFrame":
        return NumberedFrame(self.arbitration_id, self.data, self.number)

    def __copy__(self) -> "NumberedFrame":
        return NumberedFrame(self.arbitration_id, self.data, self.number)


class Links:
    """Present links of an interface, which may be reopened meanwhile; None is the ideal link."""

    def __init__(self) -> None:
        self.outward: FrameLink | None = None
        self.inward: FrameLink | None = None


class InterfaceWrapper:
    """Base of interfaces that pass frames over links (hal.can_interface.CanInterface)."""

    def __init__(self, inner: CanInterface, now_s: Callable[[], float]) -> None:
        """Wrap an interface; `now_s` returns the time in s."""
        self._inner = inner
        self._now_s = now_s
        self._waiting: deque[can.Message] = deque()
        self.overruns = 0
        """Number of frames dropped because a queue was full."""

    def now_s(self) -> float | None:
        """Return the simulated time in s."""
        return self._now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Accept only these standard identifiers and error frames."""
        self._inner.set_id_filter(frame_ids)

    def shutdown(self) -> None:
        """Close the wrapped interface."""
        self._inner.shutdown()

    def _on_delivered(self, frame: can.Message) -> None:
        if not frame.timestamp:  # made by the link
            frame.timestamp = self._now_s()
        self._waiting.append(frame)


class SwitchableInterface(InterfaceWrapper):
    """Wrapper of an interface that stamps frames and receives its own; its links can change at any time."""

    receives_own_frames = True

    def __init__(
        self,
        inner: CanInterface,
        links: Links,
        now_s: Callable[[], float],
        *,
        on_send: Callable[[can.Message], can.Message] | None = None,
        on_heard: Callable[[NumberedFrame], None] | None = None,
    ) -> None:
        """Wrap an interface.

        `on_send` gets each CONTROL frame before its link and returns the frame to send. `on_heard` gets each numbered
        frame that the reader receives. `now_s` returns the time in s.
        """
        super().__init__(inner, now_s)
        self._links = links
        self._on_send = on_send
        self._on_heard = on_heard
        self._sending = False

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - nothing here waits
        """Return the oldest frame or None without waiting `timeout` s. Raises can.CanError, OSError."""
        while not self._waiting:
            frame = self._inner.recv(0)
            if frame is None:
                self.overruns = self._inner.overruns
                return None
            inward = self._links.inward
            # Own confirmations and the controller's error frames bypass the link.
            if inward is None or not frame.is_rx or frame.is_error_frame:
                return self._received(frame)
            inward.carry(frame, self._on_delivered)
        return self._received(self._waiting.popleft())

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """Send a frame over the link without waiting `timeout` s. Raises OSError, can.CanError."""
        if self._on_send is not None and msg.arbitration_id == CONTROL_ID:
            msg = self._on_send(msg)
        outward = self._links.outward
        if outward is None:
            self._inner.send(msg, 0)
            return
        self._sending = True
        try:
            outward.carry(msg, self._send_to_bus)
        finally:
            self._sending = False

    def _send_to_bus(self, frame: can.Message) -> None:
        try:
            self._inner.send(frame, 0)
        except can.CanError:
            if self._sending:
                raise
            # A delayed frame meets a bus that is gone or full; no caller is left to handle the error.

    def _received(self, frame: can.Message) -> can.Message:
        if self._on_heard is not None and isinstance(frame, NumberedFrame):
            self._on_heard(frame)
        return frame
