"""Program clock of a soak with temporary faults."""

from kurt2rt.checks.faults.failing_clock import FaultyClock, RigClock
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.platform.clock import Clock


class SoakClock:
    """Clock (kurt2rt.platform.clock.Clock) with temporary faults; time lost in a fault stays lost."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._sound = RigClock(time)
        self._inner: Clock = self._sound
        self._behind_s = 0.0

    def disturb(self, disturbance: RigDisturbance) -> None:
        """Start a fault."""
        self._inner = FaultyClock(self._time, disturbance)

    def clear(self) -> None:
        """End the fault; call it after the disturbance's end."""
        self._behind_s += self._time.now_s() - self._inner.now_s()
        self._inner = self._sound

    def now_s(self) -> float:
        """Return the time under the fault. Raises BrokenClockError for kind off."""
        return self._inner.now_s() - self._behind_s

    async def wait_until(self, deadline_s: float) -> None:
        """Advance the world until the clock shows the deadline. Raises BrokenClockError for kind off."""
        await self._inner.wait_until(deadline_s + self._behind_s)
