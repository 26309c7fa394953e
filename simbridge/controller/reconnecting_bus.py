"""Bus of the simulated controller that survives the loss of its interface."""

import time
from collections.abc import Callable, Sequence

import can

from hal.bus import BusError, CanBus, FramePort
from hal.frame import Frame

REOPEN_PERIOD_S = 1.0


class ReconnectingBus:
    """Bus (simbridge.controller.telemetry.ControllerBus) that never raises.

    Without the interface nothing arrives, and sent frames are lost and counted. It is reopened once a second.
    """

    def __init__(self, bus: CanBus, now_s: Callable[[], float] = time.monotonic) -> None:
        """Wrap a bus, which the caller shuts down."""
        self._bus = bus
        self._now_s = now_s
        self._reopen_at_s: float | None = None
        self._failed = False
        self.error_text = ""
        """Cause of the interruption at the last drain; empty without one."""
        self.lost = 0
        """Number of frames that the bus refused."""

    def drain(self) -> list[can.Message]:
        """Return the received frames, oldest first, without blocking."""
        self._update_state()
        try:
            return self._bus.drain()
        except BusError as error:
            self._record(error)
            return []

    def telemetry_port(self) -> "ReconnectingPort":
        """Return a sender of all frames except CONTROL."""
        return ReconnectingPort(self, self._bus.telemetry_port())

    def _update_state(self) -> None:
        """Update the state from the last cycle: the bus is well if nothing failed in it."""
        if not self._failed:
            self._reopen_at_s = None
            self.error_text = ""
            return
        self._failed = False
        now_s = self._now_s()
        if self._reopen_at_s is None:
            self._reopen_at_s = now_s + REOPEN_PERIOD_S
        elif now_s >= self._reopen_at_s:
            self._reopen_at_s = now_s + REOPEN_PERIOD_S
            try:
                self._bus.reopen()
            except BusError as error:
                self.error_text = str(error)

    def _record(self, error: BusError) -> None:
        self._failed = True
        self.error_text = self.error_text or str(error)


class ReconnectingPort:
    """Port through which a ReconnectingBus sends; what it refuses is counted as lost."""

    def __init__(self, bus: ReconnectingBus, port: FramePort) -> None:
        self._bus = bus
        self._port = port

    def send(self, frame: can.Message) -> None:
        """Send without blocking; count the frame as lost if the bus refuses it. Raises ValueError for CONTROL."""
        try:
            self._port.send(frame)
        except BusError as error:
            self._bus.lost += 1
            self._bus._record(error)

    def send_all(self, frames: Sequence[Frame]) -> None:
        """Send frames in order; each may be lost, as by `send`. Raises ValueError for CONTROL."""
        for frame in frames:
            self.send(frame)
