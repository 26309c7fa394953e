"""What every kind of bus offers: one end of it, as python-can would, with a clock and a word about its own frames."""

from typing import Protocol

import can


class CanInterface(Protocol):
    """One end of a bus of some kind. Nothing here waits; errors are can.CanError, OSError or ValueError.

    A frame arrives once at every other end, in the order in which the bus carried it. Error frames of the bus are
    delivered too (`is_error_frame`, laid out as Linux does).
    """

    receives_own_frames: bool
    """True when an end hears its own frames, too (`is_rx` False), as soon as the bus has carried them."""

    overruns: int
    """Frames since it was opened that were gone before this end took them, for it was behind."""

    def now_s(self) -> float | None:
        """The present on the clock that stamps the frames; None where they count as just arrived."""
        ...

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """From now on deliver only frames with these standard identifiers, and error frames."""
        ...

    def recv(self, timeout: float | None) -> can.Message | None:
        """The frame that waits longest; None when there is none. It is called with 0.

        An end whose bus went away fails each time from then on, so that its silence is not taken for a quiet bus.
        """
        ...

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Put a frame on its way, whatever happened before. It is called with 0."""
        ...

    def shutdown(self) -> None:
        """Give the bus back; may be called twice."""
        ...
