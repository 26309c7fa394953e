"""Interface of every kind of bus: one end, as in python-can, with a clock and confirmations of own frames."""

from typing import Protocol

import can


class CanInterface(Protocol):
    """One end of a bus of some kind. Nothing here waits; errors are can.CanError, OSError or ValueError.

    A frame arrives once at every other end, in the order in which the bus carried it. Error frames of the bus are
    delivered too (`is_error_frame`, laid out as Linux does).
    """

    receives_own_frames: bool
    """True if an end also receives its own frames (`is_rx` False), as soon as the bus has carried them."""

    overruns: int
    """Frames lost since the end was opened because it read too late."""

    def now_s(self) -> float | None:
        """Return the present in s on the clock that stamps the frames; None if frames count as just arrived."""
        ...

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Deliver only frames with these standard identifiers, and error frames.

        Raises can.CanError or OSError.
        """
        ...

    def recv(self, timeout: float | None) -> can.Message | None:
        """Return the oldest waiting frame, or None; called with `timeout` 0 seconds.

        Raises can.CanError or OSError on every call after the bus is lost, so silence is never taken for a quiet bus.
        """
        ...

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame, also after failures; called with `timeout` 0 seconds.

        Raises can.CanError or OSError if the bus does not take it, ValueError for a frame that is not classic CAN.
        """
        ...

    def shutdown(self) -> None:
        """Close this end; may be called twice."""
        ...
