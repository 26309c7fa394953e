"""Time of each tick by stage, in memory of constant size."""

import time
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np


class Stage(IntEnum):
    """Stage of a tick, in order of time, as `TickTimer` measures them."""

    SENSE = 0
    PERCEIVE = 1
    DECIDE = 2
    GUARD = 3
    LEARN = 4
    PUBLISH = 5


@dataclass(frozen=True, slots=True)
class Percentiles:
    """Percentiles in µs of durations or latenesses of the ticks that `TickTimer` keeps."""

    median_us: float
    p99_us: float
    worst_us: float


def percentiles_of(took_ns: Sequence[int] | np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> Percentiles:
    """Return median, p99 and maximum of durations in ns, shape (n,); zeros if n is 0."""
    if len(took_ns) == 0:
        return Percentiles(0.0, 0.0, 0.0)
    median, p99, worst = np.percentile(took_ns, (50, 99, 100)) / 1000.0
    return Percentiles(float(median), float(p99), float(worst))


class TickTimer:
    """Timer of the last `capacity` ticks: time per stage and per tick, lateness, missed ticks."""

    def __init__(self, capacity: int = 6000) -> None:
        self._capacity = capacity
        self._stages = [array("q", bytes(8 * capacity)) for _ in Stage]
        self._lateness = array("q", bytes(8 * capacity))
        self._row = 0
        self._last_ns = 0
        self.ticks = 0
        self.missed_ticks = 0

    def begin(self, lateness_s: float) -> None:
        """Begin a tick that starts `lateness_s` seconds after its deadline; call `lap` per stage, then `end`."""
        self._lateness[self._row] = int(lateness_s * 1e9)
        self._last_ns = time.perf_counter_ns()

    def lap(self, stage: Stage) -> None:
        """End `stage`; the next stage begins."""
        now_ns = time.perf_counter_ns()
        self._stages[stage][self._row] = now_ns - self._last_ns
        self._last_ns = now_ns

    def end(self) -> None:
        """End the tick and count it; call it once per `begin`, after the last `lap`."""
        self.ticks += 1
        self._row = self.ticks % self._capacity

    def tick(self) -> Percentiles:
        """Return median, p99 and maximum of the time of all stages together, in µs; zeros before the first tick."""
        return self._share(np.sum([np.array(column) for column in self._stages], axis=0))

    def lateness(self) -> Percentiles:
        """Return the lateness of the last `capacity` ticks, in µs; zeros before the first tick."""
        return self._share(np.array(self._lateness))

    def lateness_of_last(self, ticks: int) -> Percentiles:
        """Return the lateness of the last `ticks` finished ticks, in µs, as far as they are kept."""
        kept = min(ticks, self.ticks, self._capacity)
        rows = np.arange(self.ticks - kept, self.ticks) % self._capacity
        return percentiles_of(np.array(self._lateness)[rows])

    def _share(self, nanoseconds: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> Percentiles:
        return percentiles_of(nanoseconds[: min(self.ticks, self._capacity)])
