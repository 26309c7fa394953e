"""Clocks of a fault scenario: simulated time, and a faulty one."""

import math

from anyio.lowlevel import checkpoint

from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.platform.clock import Clock

_LOOK_S = 0.0005
_LOST_SHARE = 0.5
_WAITS_PER_CHECKPOINT = 100


class RigClock:
    """Clock of the runtime in simulated time (kurt2rt.platform.clock.Clock): waiting advances the time."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._waits = 0

    def now_s(self) -> float:
        """Return the simulated time in s."""
        return self._time.now_s()

    async def wait_until(self, deadline_s: float) -> None:
        """Advance the world to the deadline."""
        self._time.run_until(deadline_s)
        self._waits += 1
        if self._waits % _WAITS_PER_CHECKPOINT == 0:
            await checkpoint()


class BrokenClockError(OSError):
    """Clock that cannot be read."""


class FaultyClock:
    """Faulty clock that wakes the loop by its own time, like the kernel's timers.

    off: reading and waiting fail. stuck: it stops. garbage: NaN. wrong: set back. slow: half speed. delayed: it lags.
    intermittent: it jumps ahead and back.
    """

    def __init__(self, time: SimulatedTime, disturbance: RigDisturbance) -> None:
        self._time = time
        self._disturbance = disturbance
        self._sound = RigClock(time)

    def now_s(self) -> float:
        """Return the time that the faulty clock shows, in s; NaN for kind garbage.

        Raises BrokenClockError for kind off.
        """
        disturbance, true_s = self._disturbance, self._time.now_s()
        if disturbance.kind == "garbage" and disturbance.acts(true_s):
            return math.nan
        return self._shown_s(true_s)

    async def wait_until(self, deadline_s: float) -> None:
        """Wait until the faulty time reaches the deadline. Raises BrokenClockError for kind off."""
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


class SoakClock:
    """Clock (kurt2rt.platform.clock.Clock) with temporary faults; time lost in a fault stays lost."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._sound = RigClock(time)
        self._inner: Clock = self._sound
        self._behind_s = 0.0

    def disturb(self, disturbance: RigDisturbance) -> None:
        """Let the clock show the faulty time of a disturbance, until `clear`."""
        self._inner = FaultyClock(self._time, disturbance)

    def clear(self) -> None:
        """End the fault; call it after the disturbance's end."""
        self._behind_s += self._time.now_s() - self._inner.now_s()
        self._inner = self._sound

    def now_s(self) -> float:
        """Return the time in s that the clock shows under its fault. Raises BrokenClockError for kind off."""
        return self._inner.now_s() - self._behind_s

    async def wait_until(self, deadline_s: float) -> None:
        """Advance the world until the clock shows the deadline. Raises BrokenClockError for kind off."""
        await self._inner.wait_until(deadline_s + self._behind_s)
