"""Bus interface of the simulated micro-controller."""

from collections.abc import Sequence
from typing import Protocol

import can

from hal.frame import Frame


class SendingPort(Protocol):
    """Sender of telemetry frames (hal.bus.FramePort)."""

    def send(self, frame: can.Message) -> None:
        """Send a frame without blocking. Raises hal.bus.BusError."""
        ...

    def send_all(self, frames: Sequence[Frame]) -> None:
        """Send frames in order without blocking. Raises hal.bus.BusError."""
        ...


class ControllerBus(Protocol):
    """Bus of the controller (hal.bus.CanBus)."""

    def drain(self) -> list[can.Message]:
        """Return the received frames, oldest first, without blocking. Raises hal.bus.BusError."""
        ...

    def telemetry_port(self) -> SendingPort:
        """Return a sender of all frames except CONTROL; may be called several times."""
        ...
