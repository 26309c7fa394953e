"""The program's clock: simulated time, wrong for a while."""

from kurt2rt.checks.faults.failing_clock import FaultyClock, RigClock
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.platform.clock import Clock


class SoakClock:
    """A clock (kurt2rt.platform.clock.Clock) that may fail and be well again; what it lost it does not get back."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._sound = RigClock(time)
        self._inner: Clock = self._sound
        self._behind_s = 0.0

    def disturb(self, disturbance: RigDisturbance) -> None:
        """From now on it is wrong."""
        self._inner = FaultyClock(self._time, disturbance)

    def clear(self) -> None:
        """It is right again. Not to be called before the disturbance's end."""
        self._behind_s += self._time.now_s() - self._inner.now_s()
        self._inner = self._sound

    def now_s(self) -> float:
        """The time, or a wrong one. Raises BrokenClockError while it is off."""
        return self._inner.now_s() - self._behind_s

    async def wait_until(self, deadline_s: float) -> None:
        """Let the world go on until it shows the deadline. Raises BrokenClockError while it is off."""
        await self._inner.wait_until(deadline_s + self._behind_s)
