"""Progress of teaching in the last minute, as the health report tells it."""

from dataclasses import dataclass

WINDOW_S = 60


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of teaching in the last minute of a run: time driven by RLAs, and questions.

    In the first minute it covers the time since the start.
    """

    seconds: int
    """Number of counted seconds, including the current one, 0 to 60."""
    driven_percent: int | None
    """Percentage of ticks in which an RLA drove the wheels, rounded down; None before the first tick."""
    asks: int
    """Number of questions that began."""


NO_PROGRESS = Progress(seconds=0, driven_percent=None, asks=0)
