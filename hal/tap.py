"""Whoever looks on at one end of a bus: a log, for instance."""

from typing import Protocol

import can


class Tap(Protocol):
    """Sees each frame that passes an end. It neither waits nor raises, and changes no frame; from any thread."""

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        """A frame of another end was taken from the bus, which carried it `age_s` ago, never less than 0."""
        ...

    def on_tx(self, frame: can.Message) -> None:
        """The bus took a frame of this end just now. The object may be sent again: its payload never changes."""
        ...
