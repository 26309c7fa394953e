"""Time of a simulated robot: real time, or up to ten times as fast in lockstep with its world."""

from typing import Protocol

from kurt2rt.platform.clock import Clock

_MEASURED_OVER_S = 1.0


class HeldWorld(Protocol):
    """World that a `SimulatedClock` drives: its own thread steps it in real time, or the clock does."""

    def hold(self) -> None:
        """Stop the world's own thread from stepping, until `go_on`."""
        ...

    def step(self) -> None:
        """Step one cycle of a held world, in the caller's thread."""
        ...

    def go_on(self) -> None:
        """Let the world's own thread step again, after `hold`."""
        ...


class Speed(Protocol):
    """Ratio of robot time to real time, for the teachers' channel: chosen, and as it was reached."""

    @property
    def wanted(self) -> int:
        """Chosen ratio of robot time to real time."""
        ...

    @property
    def reached(self) -> float:
        """Ratio of robot time to real time, measured over the last second."""
        ...

    def set(self, times: int) -> None:
        """Choose a ratio from the next tick on. Raises ValueError outside 1 to the fastest."""
        ...


class SimulatedClock:
    """Clock whose robot time may pass faster than real time.

    At speed 1 it is the real clock, and the world goes on in its own thread. At any other speed robot time passes tick
    by tick: the world takes one step before each, and real time only says when. A computer that cannot keep up makes
    robot time slower, never a tick late or missed.
    """

    def __init__(self, real: Clock, world: HeldWorld, fastest: int) -> None:
        """`fastest`: highest ratio of robot time to real time."""
        self._real = real
        self._world = world
        self._fastest = fastest
        self._speed = self._wanted = 1
        self._ahead_s = 0.0
        """Offset of robot time from the real clock at speed 1, in s."""
        self._now_s = 0.0
        """Robot time at speeds other than 1, in s."""
        self._due_s = 0.0
        """Due time of the newest tick, by the real clock."""
        self._measured_from_s = real.now_s(), real.now_s()
        """Real time and robot time at the beginning of the second that is being measured."""
        self._reached = 1.0

    @property
    def wanted(self) -> int:
        """Chosen ratio of robot time to real time."""
        return self._wanted

    @property
    def reached(self) -> float:
        """Ratio of robot time to real time, measured over the last second."""
        return self._reached

    def set(self, times: int) -> None:
        """Choose a ratio from the next tick on. Raises ValueError outside 1 to the fastest."""
        if not 1 <= times <= self._fastest:
            raise ValueError(f"speed: {times} is not possible; give 1 to {self._fastest}")
        self._wanted = times

    def now_s(self) -> float:
        """Return robot time in s."""
        return self._real.now_s() + self._ahead_s if self._speed == 1 else self._now_s

    async def wait_until(self, deadline_s: float) -> None:
        """Return at the deadline in robot time; at a speed other than 1, step the world once."""
        if self._wanted != self._speed:
            self._change()
        self._measure()
        if self._speed == 1:
            await self._real.wait_until(deadline_s - self._ahead_s)
            return
        pause_s = max(0.0, deadline_s - self._now_s) / self._speed
        # Lost time is not caught up.
        self._due_s = max(self._due_s + pause_s, self._real.now_s())
        await self._real.wait_until(self._due_s)
        self._world.step()
        self._now_s = max(self._now_s, deadline_s)

    def _change(self) -> None:
        now_s, real_s = self.now_s(), self._real.now_s()
        if self._speed == 1:
            self._world.hold()
        self._speed = self._wanted
        self._now_s, self._due_s, self._ahead_s = now_s, real_s, now_s - real_s
        self._measured_from_s, self._reached = (real_s, now_s), float(self._speed)
        if self._speed == 1:
            self._world.go_on()

    def _measure(self) -> None:
        real_s, now_s = self._real.now_s(), self.now_s()
        real_from_s, from_s = self._measured_from_s
        if real_s - real_from_s >= _MEASURED_OVER_S:
            self._reached = (now_s - from_s) / (real_s - real_from_s)
            self._measured_from_s = real_s, now_s
