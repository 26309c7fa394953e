"""CAN interface on a simulated wire."""

import can

from simbridge.wire.settings import NodeSettings
from simbridge.wire.wire import Wire


class WireInterface:
    """Controller on the wire with its reader (hal.can_interface.CanInterface).

    Opening one plugs an adapter in: its counters start at zero.
    """

    receives_own_frames = True

    def __init__(self, wire: Wire, settings: NodeSettings) -> None:
        self._wire = wire
        self._node = wire.join(settings)
        self._open = True
        self.overruns = 0
        """Number of frames dropped because the reader's buffer was full."""

    def now_s(self) -> float | None:
        """Return the wire's time in s, which stamps the frames."""
        return self._wire.now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Accept only these standard identifiers and error frames."""
        self._wire.set_id_filter(self._node, frame_ids)

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - it never waits
        """Return the oldest frame or None without waiting `timeout` s. Raises can.CanOperationError after shutdown."""
        self._check_open()
        frame = self._wire.recv(self._node)
        self.overruns = self._node.overruns
        return frame

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Queue a frame of classic CAN without waiting `timeout` s; an error frame travels like a data frame.

        Raises can.CanOperationError after shutdown or if the queue is full.
        """
        self._check_open()
        self._wire.enqueue(self._node, msg)

    def shutdown(self) -> None:
        """Unplug the controller: a frame on the wire is finished, queued ones are lost. Repeated calls do nothing."""
        if self._open:
            self._open = False
            self._wire.unplug(self._node)

    def _check_open(self) -> None:
        if not self._open:
            raise can.CanOperationError("this end of the wire is shut down")
