"""Observer of the frames at one end of a bus, such as a log."""

from typing import Protocol

import can


class Tap(Protocol):
    """Observer of each frame that passes an end. Methods never wait, raise or change a frame. Any thread calls them."""

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        """Note a frame of another end that the bus carried `age_s` seconds ago, at least 0."""
        ...

    def on_tx(self, frame: can.Message) -> None:
        """Note a frame of this end that the bus accepted. The object may be sent again; its payload never changes."""
        ...
