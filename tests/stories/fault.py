"""Simulated time, and the faults in it that robot and program ask about."""

import heapq
from collections.abc import Callable

from tests.stories.table import Fault, Target


class SimulatedTime:
    """Time that passes only in `run_until`, with callbacks on the way.

    A tick that hangs calls `run_until` itself: controller and watchdog continue, the loop does not.
    """

    def __init__(self) -> None:
        self._now_s = 0.0
        self._planned: list[tuple[float, int, Callable[[], object]]] = []
        self._numbers = 0

    def now_s(self) -> float:
        return self._now_s

    def at(self, time_s: float, act: Callable[[], object]) -> None:
        """Schedule a callback; a past time means as soon as time passes. Equal times run in order of scheduling."""
        self._numbers += 1
        heapq.heappush(self._planned, (time_s, self._numbers, act))

    def every(self, period_s: float, first_s: float, act: Callable[[], None]) -> None:
        """Schedule a callback at `first_s` and after each whole period, without end."""

        def plan(number: int) -> None:
            def once() -> None:
                act()
                plan(number + 1)

            self.at(first_s + number * period_s, once)

        plan(0)

    def run_until(self, time_s: float) -> None:
        """Advance the time, never backwards, and run the callbacks that are due."""
        while self._planned and self._planned[0][0] <= time_s:
            moment_s, _, act = heapq.heappop(self._planned)
            self._now_s = max(self._now_s, moment_s)
            act()
        self._now_s = max(self._now_s, time_s)


class FaultInjection:
    """Faults that are planned, under way or just over, at most one of each target, shared by all that may fail."""

    def __init__(self, time: SimulatedTime) -> None:
        self.time = time
        self.acted: set[Fault] = set()
        """Faults that have changed something."""
        self._faults: dict[Target, Fault] = {}

    def plan(self, fault: Fault) -> None:
        """Plan a fault in place of the one before of its target."""
        self._faults[fault.target] = fault

    def end(self, target: Target) -> None:
        """Forget the fault of a target."""
        self._faults.pop(target, None)

    def of(self, target: Target) -> Fault | None:
        """Return the fault of a target, also before its beginning and after its end."""
        return self._faults.get(target)

    def acting_on(self, target: Target) -> Fault | None:
        """Return the fault of a target if it acts now."""
        fault = self._faults.get(target)
        if fault is None or not fault.acts(self.time.now_s()):
            return None
        self.acted.add(fault)
        return fault

    def wall_clock_step_s(self) -> float:
        """Return how far the notebook's wall clock is ahead, in s."""
        fault = self.acting_on("wall_clock")
        return 0.0 if fault is None else fault.delay_s * (1.0 if fault.kind == "ahead" else -1.0)
