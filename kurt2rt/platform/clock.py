"""Clock of the runtime, and the simulated clock of lockstep."""

from collections.abc import Callable
from typing import Protocol

from anyio.lowlevel import checkpoint


class Clock(Protocol):
    """Time of the runtime in s from an arbitrary start, never backwards; passed in, never read from the system.

    A robot has the computer's clock; simulation and studies have `LockstepClock`, which jumps to each deadline.
    """

    def now_s(self) -> float:
        """Return the present time in s."""
        ...

    async def wait_until(self, deadline_s: float) -> None:
        """Return at the deadline, or at once when it has passed."""
        ...


class LockstepClock:
    """Simulated time: waiting makes it pass, as fast as the processor allows.

    Before each deadline the world takes its step, so that world and runtime alternate. The event loop gets one turn
    per `steps_per_checkpoint` steps: a checkpoint costs as much as a fifth of a tick.
    """

    def __init__(self, step_world: Callable[[], None], *, steps_per_checkpoint: int = 100) -> None:
        self._step_world = step_world
        self._steps_per_checkpoint = steps_per_checkpoint
        self._steps = 0
        self._now_s = 0.0

    def now_s(self) -> float:
        """Return simulated time in s."""
        return self._now_s

    def step_until(self, deadline_s: float) -> None:
        """Let the world take one step and jump to the deadline, in s, without an event loop."""
        self._step_world()
        self._now_s = max(self._now_s, deadline_s)

    async def wait_until(self, deadline_s: float) -> None:
        """Let the world take one step and jump to the deadline."""
        self.step_until(deadline_s)
        self._steps += 1
        if self._steps % self._steps_per_checkpoint == 0:
            await checkpoint()
