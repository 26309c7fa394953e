"""One end of a wire as a bus that hal.bus.CanBus can use."""

import can

from simbridge.wire.settings import NodeSettings
from simbridge.wire.wire import Wire


class WireEnd:
    """A controller of its own on the wire, with its reader (hal.bus_end.BusEnd).

    Opening one is plugging an adapter in: its counters begin at zero.
    """

    confirms = True

    def __init__(self, wire: Wire, settings: NodeSettings) -> None:
        self._wire = wire
        self._node = wire.join(settings)
        self._open = True
        self.lost = 0
        """Frames that found the reader's buffer full."""

    def now_s(self) -> float | None:
        """The present on the wire's clock, which stamps the frames."""
        return self._wire.now_s()

    def listen_to(self, frame_ids: frozenset[int]) -> None:
        """Take only frames with these standard identifiers, and error frames, of those that end from now on."""
        self._node.heard_ids = frame_ids

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - it never waits
        """The frame that waits longest; None when there is none. Raises can.CanOperationError after shutdown."""
        self._check_open()
        frame = self._wire.take(self._node)
        self.lost = self._node.overrun
        return frame

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Queue a classic data or remote frame. Raises can.CanOperationError (queue full, shut down), ValueError."""
        self._check_open()
        if msg.is_fd or msg.is_error_frame or msg.dlc > 8:
            raise ValueError("a wire carries classic data and remote frames of at most 8 bytes")
        self._wire.put(self._node, msg)

    def shutdown(self) -> None:
        """Unplug it when what it has queued is out; may be called twice."""
        if self._open:
            self._open = False
            self._wire.leave(self._node)

    def _check_open(self) -> None:
        if not self._open:
            raise can.CanOperationError("this end of the wire is shut down")
