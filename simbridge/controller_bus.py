"""What a micro-controller needs of its end of the bus."""

from typing import Protocol

import can


class SendingPort(Protocol):
    """A way out to the bus (hal.bus.FramePort)."""

    def send(self, frame: can.Message) -> None:
        """Send without waiting."""
        ...


class ControllerBus(Protocol):
    """The controller's end of a bus (hal.bus.CanBus)."""

    def drain(self) -> list[can.Message]:
        """Every frame of others that waits, oldest first, without blocking."""
        ...

    def telemetry_port(self) -> SendingPort:
        """A way out for every frame except CONTROL."""
        ...
