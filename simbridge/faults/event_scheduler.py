"""Event queue of simulated time, finer than a controller cycle."""

import heapq
from collections.abc import Callable


class EventScheduler:
    """Scheduler of callbacks in simulated time, which passes only in `run_until`.

    A tick that hangs calls `run_until` itself: controller and watchdog continue, the loop does not.
    """

    def __init__(self) -> None:
        self._now_s = 0.0
        self._planned: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = 0

    def now_s(self) -> float:
        """Return the time in seconds."""
        return self._now_s

    def at(self, time_s: float, act: Callable[[], None]) -> None:
        """Schedule a callback; a past time means as soon as time passes. Equal times run in order of scheduling."""
        self._numbers += 1
        heapq.heappush(self._planned, (time_s, self._numbers, act))

    def every(self, period_s: float, first_s: float, act: Callable[[], None]) -> None:
        """Schedule a callback at `first_s` and after each whole period, without end."""

        def once(number: int) -> None:
            act()
            plan(number + 1)

        def plan(number: int) -> None:
            self.at(first_s + number * period_s, lambda: once(number))

        plan(0)

    def run_until(self, time_s: float) -> None:
        """Advance the time to `time_s`, never backwards, and run the callbacks that are due."""
        while self._planned and self._planned[0][0] <= time_s:
            moment_s, _, act = heapq.heappop(self._planned)
            self._now_s = max(self._now_s, moment_s)
            act()
        self._now_s = max(self._now_s, time_s)
