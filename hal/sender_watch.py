"""Detection of a second sender of an identifier: its frames come more often than one controller can send them."""

import math
from collections.abc import Collection, Sequence

_LOOK_TICKS = 25
"""Ticks between two looks: looking in each tick would take 5 % of it."""
_PUT_OFF_TICKS = 4
"""Ticks by which a look is put off at most, while the bus holds more than a program takes at once."""
_LEAST_SHARE = 0.95
"""Shortest time between two frames, as a share of the period: no quartz is wrong by 5 %."""
_AHEAD_S = 0.2
"""Time by which frames may come before they are due, because an adapter delivers in bursts."""
_LASTS_S = 1.0
"""Time for which a second sender counts as present after its last surplus frame."""


class SenderWatch:
    """Detector of identifiers with more than one sender, by frames and the time in which they may have been sent.

    A frame is due one period after the frame before, or after the last look that found the identifier if that is later.
    So frames that waited raise no alarm: not in this program, nor in an adapter or a controller that was silent.

    Source: virtual scheduling of the generic cell rate algorithm, ITU-T I.371, A.1.
    """

    def __init__(self, names: Sequence[str], frames: Collection[int], period_s: float) -> None:
        """Watch identifiers with these names, each of which one controller sends every `period_s` seconds at most.

        `frames`: view of the number of frames of each so far, which goes on counting.
        """
        self._names = names
        self._frames = frames
        self._counted = list(frames)
        self._least_s = _LEAST_SHARE * period_s
        self._due_s = [-math.inf] * len(names)
        self._heard_s = [-math.inf] * len(names)
        self._ticks = 0
        self._now_s = self._bus_now_s = math.inf
        # Own clock, which goes as far as the faster one of both: either may be set back or be slow.
        self._time_s = 0.0
        self._surplus_at_s = -math.inf
        self.surplus = ""
        """Name of an identifier that a second node sends; empty without one, and 1 s after its last surplus frame."""

    def update(self, now_s: float, bus_now_s: float | None, *, more_wait: bool) -> None:
        """Look at the frames counted so far, in every 25th tick. Call it in each tick, after its frames.

        Args:
            now_s: time of the tick in s on the runtime's clock.
            bus_now_s: the present in s on the clock of the bus; None without one.
            more_wait: whether the bus may hold more frames that waited.
        """
        self._ticks += 1
        if self._ticks < _LOOK_TICKS or (more_wait and self._ticks < _LOOK_TICKS + _PUT_OFF_TICKS):
            return
        self._ticks = 0
        bus_now_s = now_s if bus_now_s is None else bus_now_s
        self._time_s += max(0.0, now_s - self._now_s, bus_now_s - self._bus_now_s)
        self._now_s, self._bus_now_s = now_s, bus_now_s
        if self.surplus and self._time_s - self._surplus_at_s >= _LASTS_S:
            self.surplus = ""
            self._due_s = [-math.inf] * len(self._names)
        for place, frames in enumerate(self._frames):
            came, self._counted[place] = frames - self._counted[place], frames
            if came:
                self._count(place, came)

    def _count(self, place: int, came: int) -> None:
        latest_s = self._time_s + _AHEAD_S
        due_s = max(self._due_s[place], self._heard_s[place]) + came * self._least_s
        if due_s > latest_s:
            self.surplus, self._surplus_at_s = self._names[place], self._time_s
        self._due_s[place] = min(due_s, latest_s)
        self._heard_s[place] = self._time_s
