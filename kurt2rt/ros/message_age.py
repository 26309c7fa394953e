"""Age of messages by the stamps of their headers."""

from hal.sender_clock import SenderClock
from kurt2rt.ros.messages import Message, Time, to_seconds

DRIFT = 0.0005
"""Largest drift of two clocks that nothing keeps together, 0.5 ms a second; quartzes drift by a tenth of it."""
_SLACK_S = 0.1
"""Jitter of a wireless network; a third of what `stale_encoder_s` allows."""


class StampedAge:
    """Ages of one topic's messages. A message never counts as younger than its time since arrival."""

    def __init__(self, now_s: float, wall_s: float) -> None:
        """Start without a message, at a moment that both clocks of this machine give; senders stamp by wall clocks."""
        self.clock = SenderClock(DRIFT, _SLACK_S, agreed_offset_s=now_s - wall_s)

    def on_arrival(self, message: Message, arrival_s: float) -> float | None:
        """Return a message's age at its arrival, in s, 0 if its sender stamps nothing.

        None: its stamp does not go on from those before. `arrival_s`: on this machine's monotonic clock.
        """
        stamp = getattr(getattr(message, "header", None), "stamp", None)
        stamp_s = to_seconds(stamp) if isinstance(stamp, Time) else 0.0
        return self.clock.age_s(stamp_s, arrival_s) if stamp_s > 0 else 0.0
