"""Detection of a second sender of an identifier: its frames come more often than one controller can send them."""

import math
from collections.abc import Mapping

_LEAST_SHARE = 0.95
"""Shortest time between two frames, as a share of the period: no quartz is wrong by 5 %."""
_AHEAD_S = 0.4
"""Time by which frames may come before they are due, because an adapter delivers in bursts.

A second sender needs 0.45 s for it, and 0.95 s if it sends half as often."""
_LASTS_S = 1.0
"""Time for which a second sender counts as present after its last surplus frame."""
_SET_BACK_S = 0.1
"""Time that the clock of the stamps may lose in one tick before it counts as set back: a tick may be preempted between
its two clock readings."""


class SenderWatch:
    """Detector of identifiers with more than one sender.

    It reckons on the clock of the time stamps: each frame is due one period after the frame before it, or after its own
    stamp if that is later. So frames that waited raise no alarm, however many come at once.

    Source: virtual scheduling of the generic cell rate algorithm, ITU-T I.371, A.1.
    """

    def __init__(self, names: Mapping[int, str], period_s: float) -> None:
        """Watch identifiers with these names, each of which one controller sends every `period_s` seconds at most."""
        self._names = names
        self._least_s = _LEAST_SHARE * period_s
        self._due_s = dict.fromkeys(names, -math.inf)
        self._now_s = self._clock_s = self._latest_s = -math.inf
        self._surplus_at_s = -math.inf
        self.surplus = ""
        """Name of the identifier that a second node sends; empty without one, and 1 s after its last surplus frame."""

    def begin(self, now_s: float, bus_now_s: float | None) -> float | None:
        """Begin a tick at `now_s`; return None, or without stamps the time in s since which the tick's frames came.

        Args:
            now_s: time of the tick in s on the runtime's clock.
            bus_now_s: the present in s on the clock of the stamps; None without stamps.
        """
        clock_s = now_s if bus_now_s is None else bus_now_s
        since_s = self._clock_s
        if clock_s - since_s < max(0.0, now_s - self._now_s) - _SET_BACK_S:
            # Stamps of before are in the future of the new ones.
            since_s = -math.inf
            self._due_s = dict.fromkeys(self._due_s, -math.inf)
        self._now_s, self._clock_s, self._latest_s = now_s, clock_s, clock_s + _AHEAD_S
        if now_s - self._surplus_at_s >= _LASTS_S:
            self.surplus = ""
        return since_s if bus_now_s is None else None

    def count(self, frame_id: int, came_s: float) -> None:
        """Count a frame of a watched identifier that came at `came_s`, in s, at the earliest."""
        due_s = self._due_s[frame_id]
        due_s = (came_s if came_s > due_s else due_s) + self._least_s
        if due_s > self._latest_s:
            due_s = self._latest_s
            self.surplus = self._names[frame_id]
            self._surplus_at_s = self._now_s
        self._due_s[frame_id] = due_s
