"""Simulated time, and the one fault in it that robot and program ask about."""

import heapq
from collections.abc import Callable
from typing import NamedTuple

from tests.faults.table import Case, Kind, Target


class SimulatedTime:
    """Time that passes only in `run_until`, with callbacks on the way.

    A tick that hangs calls `run_until` itself: controller and watchdog continue, the loop does not.
    """

    def __init__(self) -> None:
        self._now_s = 0.0
        self._planned: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = 0

    def now_s(self) -> float:
        return self._now_s

    def at(self, time_s: float, act: Callable[[], None]) -> None:
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


class Fault(NamedTuple):
    """Fault of one target for a span of simulated time; `period_s` and `delay_s` as in the table."""

    target: Target
    kind: Kind
    begin_s: float
    end_s: float
    period_s: float
    delay_s: float

    def acts(self, now_s: float) -> bool:
        """Return whether the fault acts at `now_s`; an intermittent one acts while it fails."""
        if not self.begin_s <= now_s < self.end_s:
            return False
        return self.kind != "intermittent" or int((now_s - self.begin_s) / self.period_s) % 2 == 0


class FaultInjection:
    """The fault that is planned, under way or just over, shared by all parts that may fail."""

    def __init__(self, time: SimulatedTime) -> None:
        self.time = time
        self.fault: Fault | None = None
        self.acted = False
        """Whether the fault has changed anything yet."""

    def plan(self, case: Case, begin_s: float, lasts_s: float) -> Fault:
        """Plan the fault of a case, in place of the one before."""
        must = case.must
        end_s = begin_s + (must.lasts_s or lasts_s)
        self.fault = Fault(case.target, case.kind, begin_s, end_s, must.period_s, must.delay_s)
        self.acted = False
        return self.fault

    def end(self) -> None:
        self.fault = None

    def of(self, target: Target) -> Fault | None:
        """Return the fault of a target, also before its beginning and after its end."""
        fault = self.fault
        return fault if fault is not None and fault.target == target else None

    def acting_on(self, target: Target) -> Fault | None:
        """Return the fault of a target if it acts now."""
        fault = self.of(target)
        if fault is None or not fault.acts(self.time.now_s()):
            return None
        self.acted = True
        return fault
