"""Simulated time as a queue of events, finer than a cycle: who acts when, between two ticks and during a hung one."""

import heapq
from collections.abc import Callable


class EventScheduler:
    """Time passes only by `run_until`, and what was planned happens at its moment, in order.

    A tick that hangs lets time pass from within: controller and watchdog go on, the loop does not.
    """

    def __init__(self) -> None:
        self._now_s = 0.0
        self._planned: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = 0

    def now_s(self) -> float:
        """The present in seconds."""
        return self._now_s

    def at(self, time_s: float, act: Callable[[], None]) -> None:
        """Have `act` called at a moment; in the past means as soon as time passes. Equal moments: in order of asking.

        May be asked from within an act.
        """
        self._numbers += 1
        heapq.heappush(self._planned, (time_s, self._numbers, act))

    def every(self, period_s: float, first_s: float, act: Callable[[], None]) -> None:
        """Have `act` called at `first_s` and at each whole period after it, without end."""

        def once(number: int) -> None:
            act()
            plan(number + 1)

        def plan(number: int) -> None:
            self.at(first_s + number * period_s, lambda: once(number))

        plan(0)

    def run_until(self, time_s: float) -> None:
        """Let time pass, to `time_s` and never backwards."""
        while self._planned and self._planned[0][0] <= time_s:
            moment_s, _, act = heapq.heappop(self._planned)
            self._now_s = max(self._now_s, moment_s)
            act()
        self._now_s = max(self._now_s, time_s)
