"""The runtime's clock in a drill, sound or not."""

import math

from anyio.lowlevel import checkpoint

from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime

_LOOK_S = 0.0005
_LOST_SHARE = 0.5
_WAITS_PER_CHECKPOINT = 100


class RigClock:
    """Simulated time as the runtime's clock (kurt2rt.platform.clock.Clock): waiting makes it pass."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._waits = 0

    def now_s(self) -> float:
        """Simulated time."""
        return self._time.now_s()

    async def wait_until(self, deadline_s: float) -> None:
        """Let the world go on until the deadline."""
        self._time.run_until(deadline_s)
        self._waits += 1
        if self._waits % _WAITS_PER_CHECKPOINT == 0:
            await checkpoint()


class BrokenClockError(OSError):
    """The clock cannot be read."""


class FaultyClock:
    """A clock that fails, and wakes the loop by its own wrong time, as the kernel's timers would.

    off: neither read nor waited for. stuck: it stands still. garbage: it is not a number. wrong: it was set back.
    slow: it runs at half speed. delayed: it lags behind. intermittent: it jumps ahead and back.
    """

    def __init__(self, time: SimulatedTime, disturbance: RigDisturbance) -> None:
        self._time = time
        self._disturbance = disturbance
        self._sound = RigClock(time)

    def now_s(self) -> float:
        """The wrong time. Raises BrokenClockError when it is off."""
        disturbance, true_s = self._disturbance, self._time.now_s()
        if disturbance.kind == "garbage" and disturbance.acts(true_s):
            return math.nan
        return self._shown_s(true_s)

    async def wait_until(self, deadline_s: float) -> None:
        """Return when it shows the deadline. Raises BrokenClockError when it is off."""
        begin_s, end_s = self._disturbance.begin_s, self._disturbance.end_s
        while (now_s := self._time.now_s()) < end_s:
            if self._shown_s(now_s) >= deadline_s:
                return
            # In small steps while it is wrong, for it may jump.
            self._time.run_until(min(deadline_s, begin_s) if now_s < begin_s else now_s + _LOOK_S)
        await self._sound.wait_until(deadline_s + now_s - self._shown_s(now_s))

    def _shown_s(self, true_s: float) -> float:
        disturbance = self._disturbance
        if disturbance.kind == "slow":  # what it lost it does not get back
            return true_s - _LOST_SHARE * max(0.0, min(true_s, disturbance.end_s) - disturbance.begin_s)
        if not disturbance.acts(true_s):
            return true_s
        match disturbance.kind:
            case "off":
                raise BrokenClockError("the clock cannot be read")
            case "stuck":
                return disturbance.begin_s
            case "garbage":
                return true_s
            case "wrong" | "delayed":
                return true_s - disturbance.delay_s
            case "intermittent":
                return true_s + disturbance.delay_s
