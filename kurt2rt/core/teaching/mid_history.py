"""History of the mid level: each situation lasts from one junction to the next, so a few reach far back."""

from bisect import bisect_right
from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class MidSnapshot(NamedTuple):
    """Situation and decision of the mid level, equal for many ticks."""

    vector: NDArray[np.float64]
    """Mid-level situation, shape (d,)."""
    rla_id: int | None
    """Mid-level RLA that commanded; None if the level asked or a teacher commanded."""


class MidHistory:
    """Last `capacity` snapshots by tick, because a teacher may mean a junction of minutes ago."""

    def __init__(self, capacity: int = 64) -> None:
        self._first_ticks: deque[int] = deque(maxlen=capacity)
        self._snapshots: deque[MidSnapshot] = deque(maxlen=capacity)
        self._newest = -1

    def remember(self, tick: int, vector: NDArray[np.float64], rla_id: int | None) -> None:
        """Add the snapshot of a tick; the oldest is dropped.

        Args:
            tick: number of the tick.
            vector: mid-level situation, shape (d,). It is stored without a copy and must never change: an identical
                object is the same situation.
            rla_id: RLA that commanded; None if the level asked or a teacher commanded.
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
        """Newest snapshot; None before the first."""
        return self._snapshots[-1] if self._snapshots else None

    def get(self, tick: int) -> MidSnapshot | None:
        """Return the snapshot of a tick; None if it was dropped or is in the future."""
        place = bisect_right(self._first_ticks, tick) - 1 if tick <= self._newest else -1
        return self._snapshots[place] if place >= 0 else None
