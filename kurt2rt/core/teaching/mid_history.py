"""The latest situations of the mid level: each lasts from one junction to the next, so few of them reach far back."""

from bisect import bisect_right
from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class MidSnapshot(NamedTuple):
    """What the mid level saw and decided, the same for many ticks."""

    vector: NDArray[np.float64]
    """Mid-level situation, shape (d,)."""
    rla_id: int | None
    """The mid-level RLA that commanded; None where it asked, or a teacher commanded."""


class MidHistory:
    """The last `capacity` of them, by the ticks in which they were: a teacher may mean a junction of minutes ago."""

    def __init__(self, capacity: int = 64) -> None:
        self._first_ticks: deque[int] = deque(maxlen=capacity)
        self._snapshots: deque[MidSnapshot] = deque(maxlen=capacity)
        self._newest = -1

    def remember(self, tick: int, vector: NDArray[np.float64], rla_id: int | None) -> None:
        """Keep that of a tick; the oldest is forgotten.

        The vector is kept as it is and must never be changed in place: the same object is the same situation.
        """
        self._newest = tick
        if self._snapshots:
            last = self._snapshots[-1]
            if last.vector is vector and last.rla_id == rla_id:
                return
        self._first_ticks.append(tick)
        self._snapshots.append(MidSnapshot(vector, rla_id))

    @property
    def newest(self) -> MidSnapshot | None:
        """The newest one; None before the first."""
        return self._snapshots[-1] if self._snapshots else None

    def get(self, tick: int) -> MidSnapshot | None:
        """That of a tick; None where it is forgotten, or still to come."""
        place = bisect_right(self._first_ticks, tick) - 1 if tick <= self._newest else -1
        return self._snapshots[place] if place >= 0 else None
