"""Age of messages by their time stamps, if the clocks of both computers allow."""

import math

AGREEMENT_S = 1.0
"""Largest apparent age of a message at which the clocks are taken to agree."""

DRIFT = 0.0005
"""Largest drift of two clocks that nothing keeps together, 0.5 ms a second; quartzes drift by a tenth of it."""


class StampedAge:
    """Ages of one topic's messages. A message never counts as younger than its time since arrival.

    Clocks that agree: the message is as old as the present minus its stamp. Else only the delay against the quickest
    message so far is known: its stamp then lay so far before its arrival, and so does every later one at least.
    """

    def __init__(self) -> None:
        """Start without a message."""
        self._least_offset_s = math.inf
        self._arrived_s = -math.inf

    def on_arrival(self, stamp_s: float, arrival_s: float) -> float:
        """Return a message's age at its arrival, in s.

        `stamp_s`: its header's stamp, on the sender's clock; 0: the sender stamps nothing. `arrival_s`: its arrival on
        this machine's wall clock.
        """
        if stamp_s <= 0:
            return 0.0
        offset_s = arrival_s - stamp_s
        drifted_s = DRIFT * max(0.0, arrival_s - self._arrived_s)
        self._arrived_s = arrival_s
        self._least_offset_s = min(self._least_offset_s + drifted_s, offset_s)
        delay_s = offset_s - self._least_offset_s
        return max(delay_s, offset_s) if 0 <= offset_s <= AGREEMENT_S else delay_s
