"""Progress of teaching: the share that the robot drives by itself, and its questions, over the last minute."""

from dataclasses import dataclass

WINDOW_S = 60


@dataclass(frozen=True, slots=True)
class Progress:
    """The last minute of a run; in its first minute the time since its start."""

    seconds: int
    """Number of counted seconds, including the current one, 0 to 60."""
    driven_percent: int | None
    """Percentage of ticks in which an RLA drove the wheels, rounded down; None before the first tick."""
    asks: int
    """Number of questions that began."""


NO_PROGRESS = Progress(seconds=0, driven_percent=None, asks=0)
