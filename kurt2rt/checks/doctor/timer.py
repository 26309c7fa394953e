"""Checks of the timer that paces the ticks."""

import asyncio
import statistics
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

import anyio

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.timerfd_clock import TimerfdClock

PERIOD_S = 0.01
TOLERABLE_MEDIAN_S = 0.001
"""Limit of the median lateness; a timerfd is about 0.1 ms late, the event loop's sleep 1 ms."""


class AsyncioClock:
    """Waits by `asyncio.sleep`, as the reference for better clocks."""

    def now_s(self) -> float:
        """Return the monotonic time in s."""
        return time.monotonic()

    async def wait_until(self, deadline_s: float) -> None:
        """Return at the deadline, rounded up to the event loop's whole milliseconds."""
        await asyncio.sleep(deadline_s - time.monotonic())


@dataclass(frozen=True, slots=True)
class Lateness:
    """Lateness of a clock's waits."""

    median_s: float
    worst_s: float


async def measure_lateness(clock: Clock, ticks: int, period_s: float) -> Lateness:
    """Wait for `ticks` deadlines, a period in s apart, and return how late each wait ended."""
    start_s = clock.now_s()
    late_s = []
    for number in range(1, ticks + 1):
        deadline_s = start_s + number * period_s
        await clock.wait_until(deadline_s)
        late_s.append(clock.now_s() - deadline_s)
    return Lateness(statistics.median(late_s), max(late_s))


def check_timer(
    ticks: int = 100,
    period_s: float = PERIOD_S,
    open_clock: Callable[[], AbstractContextManager[Clock]] = TimerfdClock,
) -> CheckResult:
    """Check for a timerfd, and compare its lateness with asyncio.sleep. Takes 2 x ticks x period_s."""

    async def both() -> tuple[Lateness, Lateness]:
        with open_clock() as clock:
            ours = await measure_lateness(clock, ticks, period_s)
        return ours, await measure_lateness(AsyncioClock(), ticks, period_s)

    try:
        ours, theirs = anyio.run(both)
    except OSError as error:
        return CheckResult(FindingCode.TIMER_MISSING, CheckStatus.MISSING, {"error": str(error)}, needed=True)
    values = {
        "ticks": ticks,
        "period_ms": period_s * 1000,
        "median_ms": ours.median_s * 1000,
        "worst_ms": ours.worst_s * 1000,
        "asyncio_median_ms": theirs.median_s * 1000,
        "asyncio_worst_ms": theirs.worst_s * 1000,
        "ratio": theirs.median_s / max(ours.median_s, 1e-9),
    }
    if ours.median_s > TOLERABLE_MEDIAN_S or ours.worst_s >= period_s:
        return CheckResult(FindingCode.TIMER_LATE, CheckStatus.WARNING, values, needed=True)
    return CheckResult(FindingCode.TIMER, CheckStatus.OK, values, needed=True)
