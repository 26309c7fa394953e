"""Clock of the program in simulated time, which may fail."""

import math
from collections.abc import Callable

from anyio.lowlevel import checkpoint

from tests.stories.fault import FaultInjection

_LOOK_S = 0.0005
_LOST_SHARE = 0.5
_WAITS_PER_CHECKPOINT = 100
"""Waits between two in which other tasks may run, as long as none has work."""


class BrokenClockError(OSError):
    """Clock that cannot be read."""


class FaultyClock:
    """Clock (kurt2rt.platform.clock.Clock) that wakes the loop by its own time, like the kernel's timers.

    off: reading and waiting fail. stuck: it stops. garbage: NaN. wrong: set back. slow: half speed, and what it lost
    then stays lost. delayed: it lags. intermittent: it jumps ahead and back.
    """

    def __init__(self, injection: FaultInjection, tasks_wait: Callable[[], bool] = lambda: False) -> None:
        """`tasks_wait`: whether another task has work, such as an answer to a teacher's device."""
        self._injection, self._time, self._tasks_wait = injection, injection.time, tasks_wait
        self._lost_s = 0.0
        self._waits = 0

    def now_s(self) -> float:
        fault, shown_s = self._injection.acting_on("clock"), self._shown_s()
        return math.nan if fault is not None and fault.kind == "garbage" else shown_s

    async def wait_until(self, deadline_s: float) -> None:
        """Let time pass until the clock shows the deadline. Raises BrokenClockError for kind off."""
        time = self._time
        while (fault := self._injection.of("clock")) is not None and (now_s := time.now_s()) < fault.end_s:
            if self._shown_s() >= deadline_s:
                return
            # In small steps while it is wrong, for it may jump.
            time.run_until(min(deadline_s + self._lost_s, fault.begin_s) if now_s < fault.begin_s else now_s + _LOOK_S)
        time.run_until(time.now_s() + deadline_s - self._shown_s())
        self._waits += 1
        if self._waits % _WAITS_PER_CHECKPOINT == 0 or self._tasks_wait():
            await checkpoint()

    def repair(self) -> None:
        """Go on without the fault; call it when the fault is over."""
        self._lost_s = self._time.now_s() - self._shown_s()

    def _shown_s(self) -> float:
        now_s = self._time.now_s()
        sound_s, fault = now_s - self._lost_s, self._injection.of("clock")
        if fault is None:
            return sound_s
        if fault.kind == "slow":
            if now_s > fault.begin_s:
                self._injection.acted.add(fault)
            return sound_s - _LOST_SHARE * max(0.0, min(now_s, fault.end_s) - fault.begin_s)
        if self._injection.acting_on("clock") is None:
            return sound_s
        match fault.kind:
            case "off":
                raise BrokenClockError("the clock cannot be read")
            case "stuck":
                return fault.begin_s - self._lost_s
            case "wrong" | "delayed":
                return sound_s - fault.delay_s
            case "intermittent":
                return sound_s + fault.delay_s
            case _:
                return sound_s
