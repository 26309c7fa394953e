"""How well the robot is heard."""

import statistics
from collections import deque
from dataclasses import dataclass

_ROUND_TRIPS = 50
_ANSWERS = 100


@dataclass(frozen=True, slots=True)
class LinkQuality:
    """Of the last seconds. Presence and driving are measured, so only who is in charge has round trips."""

    rtt_ms: float | None
    """Round trip, median of the last 50 that were answered; None before the first."""
    answered: float | None
    """Share of the last 100 messages that were answered within a second; None before the first."""
    pictures_per_s: float
    """Pictures that came in the last second."""


class LinkMeter:
    """Counts round trips and answers."""

    def __init__(self) -> None:
        self._round_trips_s: deque[float] = deque(maxlen=_ROUND_TRIPS)
        self._answered: deque[bool] = deque(maxlen=_ANSWERS)

    def answer(self, after_s: float) -> None:
        """One more message was answered."""
        self._round_trips_s.append(after_s)
        self._answered.append(True)

    def silence(self) -> None:
        """One more message was not answered in time."""
        self._answered.append(False)

    def link(self, pictures_per_s: float) -> LinkQuality:
        """What was measured so far."""
        return LinkQuality(
            rtt_ms=statistics.median(self._round_trips_s) * 1000.0 if self._round_trips_s else None,
            answered=sum(self._answered) / len(self._answered) if self._answered else None,
            pictures_per_s=pictures_per_s,
        )
