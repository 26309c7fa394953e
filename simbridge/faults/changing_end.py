"""One end of a bus whose ways out and in may fail and be well again, any number of times."""

from collections import deque
from collections.abc import Callable

import can

from hal.bus import CONTROL_ID
from hal.can_interface import CanInterface
from hal.frame import Frame
from simbridge.faults.way import FrameLink


class NumberedFrame(Frame):
    """A frame that its copies can be told by."""

    __slots__ = ("number",)

    def __init__(self, frame_id: int, payload: bytes, number: int) -> None:
        super().__init__(frame_id, payload)
        self.number = number

    def __deepcopy__(self, memo: dict[int, object] | None) -> "NumberedFrame":
        return NumberedFrame(self.arbitration_id, self.data, self.number)

    def __copy__(self) -> "NumberedFrame":
        return NumberedFrame(self.arbitration_id, self.data, self.number)


class Links:
    """What an end's frames suffer now; outlives the end, which may be opened anew. None: they go straight."""

    def __init__(self) -> None:
        self.outward: FrameLink | None = None
        self.inward: FrameLink | None = None


class SwitchableInterface:
    """Wraps an end that stamps frames and confirms its own (hal.can_interface.CanInterface)."""

    receives_own_frames = True

    def __init__(
        self,
        inner: CanInterface,
        ways: Links,
        now_s: Callable[[], float],
        *,
        on_send: Callable[[can.Message], can.Message] | None = None,
        on_heard: Callable[[NumberedFrame], None] | None = None,
    ) -> None:
        """`on_send` sees each CONTROL frame before anything can happen to it, and says what is sent in its place.

        `on_heard` sees each numbered frame that its reader takes.
        """
        self._inner = inner
        self._ways = ways
        self._now_s = now_s
        self._on_send = on_send
        self._on_heard = on_heard
        self.overruns = 0
        """Frames that found no room."""
        self._sending = False
        self._waiting: deque[can.Message] = deque()

    def now_s(self) -> float | None:
        """The present."""
        return self._now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Deliver only frames with these standard identifiers, and error frames."""
        self._inner.set_id_filter(frame_ids)

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - nothing here waits
        """The frame that waits longest. Raises can.CanError, OSError."""
        while not self._waiting:
            frame = self._inner.recv(0)
            if frame is None:
                self.overruns = self._inner.overruns
                return None
            inward = self._ways.inward
            # Of what it sent itself, and of the controller's own error frames, nothing is on any way.
            if inward is None or not frame.is_rx or frame.is_error_frame:
                return self._taken(frame)
            inward.carry(frame, self._arrive)
        return self._taken(self._waiting.popleft())

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """Put a frame on its way. Raises OSError, can.CanError."""
        if self._on_send is not None and msg.arbitration_id == CONTROL_ID:
            msg = self._on_send(msg)
        outward = self._ways.outward
        if outward is None:
            self._inner.send(msg, 0)
            return
        self._sending = True
        try:
            outward.carry(msg, self._put_on_the_bus)
        finally:
            self._sending = False

    def shutdown(self) -> None:
        """Give the bus back."""
        self._inner.shutdown()

    def _put_on_the_bus(self, frame: can.Message) -> None:
        try:
            self._inner.send(frame, 0)
        except can.CanError:
            if self._sending:
                raise
            # What a way had held up comes to a bus that is gone, or full by now; nobody is there to hear of it.

    def _arrive(self, frame: can.Message) -> None:
        if not frame.timestamp:  # made on the way
            frame.timestamp = self._now_s()
        self._waiting.append(frame)

    def _taken(self, frame: can.Message) -> can.Message:
        if self._on_heard is not None and isinstance(frame, NumberedFrame):
            self._on_heard(frame)
        return frame
