"""A bus that may go and come back under the simulated controller, which goes on as a real one does."""

import time
from collections.abc import Callable

import can

from hal.bus import BusError, CanBus, FramePort

REOPEN_PERIOD_S = 1.0


class ReconnectingBus:
    """One end of a bus (simbridge.controller_bus.ControllerBus) that raises nothing.

    While the bus is gone nothing arrives and what is sent is lost and counted; once a second it is opened anew.
    """

    def __init__(self, bus: CanBus, now_s: Callable[[], float] = time.monotonic) -> None:
        """The bus stays the caller's to shut down."""
        self._bus = bus
        self._now_s = now_s
        self._reopen_at_s: float | None = None
        self._failed = False
        self.error_text = ""
        """Why nothing gets through; empty while it does. As of the last drain."""
        self.lost = 0
        """Frames that the bus did not take."""

    def drain(self) -> list[can.Message]:
        """Every frame of others that waits, oldest first, without blocking."""
        self._settle()
        try:
            return self._bus.drain()
        except BusError as error:
            self._note(error)
            return []

    def telemetry_port(self) -> "ReconnectingPort":
        """A way out for every frame except CONTROL."""
        return ReconnectingPort(self, self._bus.telemetry_port())

    def _settle(self) -> None:
        """What the cycle before has shown: the bus is well when nothing failed in it."""
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

    def _note(self, error: BusError) -> None:
        self._failed = True
        self.error_text = self.error_text or str(error)


class ReconnectingPort:
    """A way out of a ReconnectingBus."""

    def __init__(self, bus: ReconnectingBus, port: FramePort) -> None:
        self._bus = bus
        self._port = port

    def send(self, frame: can.Message) -> None:
        """Send without waiting, if the bus takes it. Raises ValueError for CONTROL."""
        try:
            self._port.send(frame)
        except BusError as error:
            self._bus.lost += 1
            self._bus._note(error)
