"""One end of a wire as a bus that hal.bus.CanBus can use."""

import can

from simbridge.wire.settings import NodeSettings
from simbridge.wire.wire import Wire


class WireInterface:
    """A controller of its own on the wire, with its reader (hal.can_interface.CanInterface).

    Opening one is plugging an adapter in: its counters begin at zero.
    """

    receives_own_frames = True

    def __init__(self, wire: Wire, settings: NodeSettings) -> None:
        self._wire = wire
        self._node = wire.join(settings)
        self._open = True
        self.overruns = 0
        """Frames that found the reader's buffer full."""

    def now_s(self) -> float | None:
        """The present on the wire's clock, which stamps the frames."""
        return self._wire.now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Take only frames with these standard identifiers, and error frames."""
        self._wire.set_id_filter(self._node, frame_ids)

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - it never waits
        """The frame that waits longest; None when there is none. Raises can.CanOperationError after shutdown."""
        self._check_open()
        frame = self._wire.take(self._node)
        self.overruns = self._node.overrun
        return frame

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Queue a frame of classic CAN. Raises can.CanOperationError when the queue is full or the end is shut down.

        An error frame that somebody sends, as tests do, travels like a data frame of its identifier.
        """
        self._check_open()
        self._wire.put(self._node, msg)

    def shutdown(self) -> None:
        """Unplug it: what is on the wire is finished, what it has queued is gone; may be called twice."""
        if self._open:
            self._open = False
            self._wire.leave(self._node)

    def _check_open(self) -> None:
        if not self._open:
            raise can.CanOperationError("this end of the wire is shut down")
