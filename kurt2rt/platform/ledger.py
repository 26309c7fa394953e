"""The ledger of time: where each tick's time went, kept in memory that does not grow."""

import time
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np


class Stage(IntEnum):
    """The stages of a tick, in order."""

    SENSE = 0
    PERCEIVE = 1
    DECIDE = 2
    GUARD = 3
    LEARN = 4
    PUBLISH = 5


@dataclass(frozen=True, slots=True)
class Percentiles:
    """Microseconds that something took, over the ticks kept."""

    median_us: float
    p99_us: float
    worst_us: float


def percentiles_of(took_ns: Sequence[int] | np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> Percentiles:
    """Median, p99 and worst of times in nanoseconds; zeros where there are none."""
    if len(took_ns) == 0:
        return Percentiles(0.0, 0.0, 0.0)
    median, p99, worst = np.percentile(took_ns, (50, 99, 100)) / 1000.0
    return Percentiles(float(median), float(p99), float(worst))


class TickTimer:
    """Time per stage and per tick, lateness and missed ticks, of the last `capacity` ticks."""

    def __init__(self, capacity: int = 6000) -> None:
        self._capacity = capacity
        self._stages = [array("q", bytes(8 * capacity)) for _ in Stage]
        self._lateness = array("q", bytes(8 * capacity))
        self._row = 0
        self._last_ns = 0
        self.ticks = 0
        self.missed_ticks = 0

    def begin(self, lateness_s: float) -> None:
        """A tick begins, so late against its deadline."""
        self._lateness[self._row] = int(lateness_s * 1e9)
        self._last_ns = time.perf_counter_ns()

    def lap(self, stage: Stage) -> None:
        """`stage` has ended just now."""
        now_ns = time.perf_counter_ns()
        self._stages[stage][self._row] = now_ns - self._last_ns
        self._last_ns = now_ns

    def end(self) -> None:
        """The tick is over."""
        self.ticks += 1
        self._row = self.ticks % self._capacity

    def stage(self, stage: Stage) -> Percentiles:
        """What one stage took."""
        return self._share(np.array(self._stages[stage]))

    def tick(self) -> Percentiles:
        """What all stages together took."""
        return self._share(np.sum([np.array(column) for column in self._stages], axis=0))

    def lateness(self) -> Percentiles:
        """How late ticks began."""
        return self._share(np.array(self._lateness))

    def lateness_of_last(self, ticks: int) -> Percentiles:
        """How late the last so many ticks began, those that are kept and over."""
        kept = min(ticks, self.ticks, self._capacity)
        rows = np.arange(self.ticks - kept, self.ticks) % self._capacity
        return percentiles_of(np.array(self._lateness)[rows])

    def _share(self, nanoseconds: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> Percentiles:
        return percentiles_of(nanoseconds[: min(self.ticks, self._capacity)])
