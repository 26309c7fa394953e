"""Plug-in of python-can: `can.Bus(interface="kurt2rt", channel="desk")` joins the bus `shared:desk`.

So python-can's own tools (`can_logger`, `can_viewer`, `can_player`) see a simulated robot. pyproject.toml names this
module in the group of entry points `can.interface`.
"""

import time
from typing import Any

import can

from hal.shared_bus import SharedBus, shared_bus_names

INTERFACE = "kurt2rt"
"""Name of the interface for python-can."""
_KIND = "shared:"


class Kurt2rtBus(SharedBus):
    """End of a shared bus as python-can's tools expect it: frames have the time since 1970, and all filters hold."""

    def __init__(
        self,
        channel: str | None = None,
        *,
        can_filters: can.typechecking.CanFilters | None = None,
        fd: bool = False,
        **options: Any,
    ) -> None:
        """Join a bus; frames count from now.

        Args:
            channel: name of the bus, such as desk or shared:desk; None is refused with the names that are there.
            can_filters: filters of python-can; None: all frames.
            fd: must be False, because the robot's bus is classic CAN.
            options: `receive_own_messages` must be False; others, such as a bit rate, have no effect in memory.

        Raises:
            can.CanInitializationError: the bus cannot be joined, or an option asks for what it cannot do.
        """
        if channel is None:
            names = ", ".join(shared_bus_names()) or "none yet; kurt2rt sim --bus shared:desk makes one"
            raise can.CanInitializationError(f"{INTERFACE}: give a channel; there are: {names}")
        if fd or options.get("receive_own_messages"):
            raise can.CanInitializationError(
                f"{INTERFACE} {channel}: CAN FD and receive_own_messages are not supported; leave both out"
            )
        try:
            super().__init__(str(channel).removeprefix(_KIND))
        except OSError as error:
            raise can.CanInitializationError(f"{INTERFACE} {channel}: cannot be joined ({error})") from error
        self._epoch_s = time.time() - time.monotonic()
        self.set_filters(can_filters)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Return the oldest frame that passes the filters, or None after `timeout` seconds; None waits without end.

        Its time stamp is in s since 1970. Raises can.CanOperationError if the bus is lost.
        """
        frame = can.BusABC.recv(self, timeout)
        if frame is not None:
            frame.timestamp += self._epoch_s
        return frame

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Append a frame; `timeout` (s) is unused.

        Raises can.CanOperationError if the bus is lost, or for a frame that is not classic CAN.
        """
        try:
            super().send(msg, timeout)
        except ValueError as error:
            raise can.CanOperationError(f"{INTERFACE} {self.channel}: {error}") from error

    @staticmethod
    def _detect_available_configs() -> list[Any]:
        """Return the configurations of all buses that a program of this user has open."""
        return [{"interface": INTERFACE, "channel": name} for name in shared_bus_names()]
