"""Progress of teaching: the share that the robot drives by itself, and its questions, over the last minute."""

from dataclasses import dataclass

WINDOW_S = 60


@dataclass(frozen=True, slots=True)
class Progress:
    """The last minute of a run; in its first minute the time since its start."""

    seconds: int
    """Whole and begun seconds that were counted, 0 to 60."""
    driven_percent: int | None
    """Ticks in which an RLA drove the wheels, in per cent of all, rounded down; None before the first tick."""
    asks: int
    """Questions that the robot began to ask."""


NO_PROGRESS = Progress(seconds=0, driven_percent=None, asks=0)
