"""Quality of the link to the robot: round trips and answered messages."""

import statistics
from collections import deque
from dataclasses import dataclass

_ROUND_TRIPS = 50
_ANSWERS = 100


@dataclass(frozen=True, slots=True)
class LinkQuality:
    """Quality of the link to the robot over the last seconds.

    Only a device in charge sends a stream, so only it has round trips.
    """

    rtt_ms: float | None
    """Round trip, median of the last 50 that were answered; None before the first."""
    answered: float | None
    """Fraction of the last 100 messages that were answered within a second; None before the first."""
    states_per_s: float
    """States that came in the last second."""


class LinkMeter:
    """Meter of the link to the robot, by the answers to the stream of presence and presses."""

    def __init__(self) -> None:
        self._round_trips_s: deque[float] = deque(maxlen=_ROUND_TRIPS)
        self._answered: deque[bool] = deque(maxlen=_ANSWERS)

    def on_answer(self, after_s: float) -> None:
        """Count a message that was answered after `after_s` seconds."""
        self._round_trips_s.append(after_s)
        self._answered.append(True)

    def on_timeout(self) -> None:
        """Count a message that was not answered in time."""
        self._answered.append(False)

    def link(self, states_per_s: float) -> LinkQuality:
        """Return the quality of the link so far, with `states_per_s`, the states that came in the last second."""
        return LinkQuality(
            rtt_ms=statistics.median(self._round_trips_s) * 1000.0 if self._round_trips_s else None,
            answered=sum(self._answered) / len(self._answered) if self._answered else None,
            states_per_s=states_per_s,
        )
