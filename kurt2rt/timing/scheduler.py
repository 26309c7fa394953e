"""The 100 Hz scheduler: one tick per period, late ones skipped whole."""

from collections.abc import Callable

from kurt2rt.tick import Tick, TickRecord
from kurt2rt.timing.clock import Clock
from kurt2rt.timing.ledger import Ledger


class Scheduler:
    """Runs a Tick at each multiple of the period.

    A tick that cannot begin within its period is missed: skipped whole and counted, never caught up in a burst.
    """

    def __init__(self, clock: Clock, tick: Tick, period_s: float, ledger: Ledger) -> None:
        self._clock = clock
        self._tick = tick
        self._period_s = period_s
        self._ledger = ledger
        self._number = 0
        self._ending = False

    def end(self) -> None:
        """Let `run` return after the tick it is in."""
        self._ending = True

    async def run(self, ticks: int | None, after_tick: Callable[[TickRecord], None]) -> None:
        """Run until `end` is called, or for so many ticks of the clock, missed ones included.

        `after_tick` sees each record when the wheels have been told; it counts against the period.
        """
        clock, period_s = self._clock, self._period_s
        last = None if ticks is None else self._number + ticks
        # Deadlines are multiples of the period from here, computed anew each time: no rounding error adds up.
        origin_s = clock.now_s() - self._number * period_s
        while not self._ending and (last is None or self._number < last):
            self._number += 1
            deadline_s = origin_s + self._number * period_s
            await clock.wait_until(deadline_s)
            now_s = clock.now_s()
            missed = int((now_s - deadline_s) / period_s)
            if missed > 0:
                self._ledger.missed_ticks += missed
                self._number += missed
                deadline_s += missed * period_s
            self._ledger.begin(now_s - deadline_s)
            after_tick(self._tick.run(self._number, now_s))
            self._ledger.end()
        self._ending = False
