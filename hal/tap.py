"""Observer of the frames at one end of a bus, such as a log."""

from typing import Protocol

import can

from config.settings import SettingsError


class Tap(Protocol):
    """Observer of each CAN frame that passes an end, such as the log of `kurt2rt run --can-log` (listener).

    Methods never wait, raise or change a frame. Any thread calls them.
    """

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        """Note a frame of another end that the bus carried `age_s` seconds ago, at least 0."""
        ...

    def on_tx(self, frame: can.Message) -> None:
        """Note a frame of this end that the bus accepted. The object may be sent again; its payload never changes."""
        ...


def refuse_tap(tap: Tap | None, robot: str) -> None:
    """Refuse a tap at the link of a robot without CAN, whose name is `robot`; do nothing without a tap.

    Raises config.settings.SettingsError.
    """
    if tap is not None:
        raise SettingsError("has no CAN frames to be seen", where=f"robot {robot}", do="leave it out")
