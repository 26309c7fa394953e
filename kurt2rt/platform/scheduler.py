"""Scheduler of the 100 Hz tick: one call per period, late ticks skipped whole."""

from collections.abc import Callable
from typing import Generic, TypeVar

from kurt2rt.platform.clock import Clock
from kurt2rt.platform.tick_timer import TickTimer

RecordT = TypeVar("RecordT")


class Scheduler(Generic[RecordT]):
    """Pacer that runs a tick at each multiple of the period.

    A tick that cannot begin within its period is missed: skipped whole and counted, never caught up in a burst.
    Each tick waits for the clock exactly once. A clock in lockstep takes one step of the world in each wait.
    """

    def __init__(
        self, clock: Clock, run_tick: Callable[[int, float], RecordT], period_s: float, timer: TickTimer
    ) -> None:
        """`run_tick`: takes the tick's number, from 1, and its time in seconds; returns the tick's record."""
        self._clock = clock
        self._run_tick = run_tick
        self._period_s = period_s
        self._timer = timer
        self._number = 0
        self._ending = False

    def end(self) -> None:
        """Let `run` return after the present tick."""
        self._ending = True

    async def run(self, ticks: int | None, after_tick: Callable[[RecordT], None]) -> None:
        """Run until `end` is called, or for `ticks` periods of the clock, missed ticks included.

        `after_tick` gets each record as soon as the wheels have their set points; its time counts against the period.
        """
        clock, period_s = self._clock, self._period_s
        last = None if ticks is None else self._number + ticks
        # Deadlines are multiples of the period from here, computed from the tick number: no rounding error adds up.
        origin_s = clock.now_s() - self._number * period_s
        while not self._ending and (last is None or self._number < last):
            self._number += 1
            deadline_s = origin_s + self._number * period_s
            await clock.wait_until(deadline_s)
            now_s = clock.now_s()
            missed = int((now_s - deadline_s) / period_s)
            if missed > 0:
                self._timer.missed_ticks += missed
                self._number += missed
                deadline_s += missed * period_s
            self._timer.begin(now_s - deadline_s)
            after_tick(self._run_tick(self._number, now_s))
            self._timer.end()
        self._ending = False
