"""The loop of an open robot, and where in the simulated robot's cycle its ticks fall."""

from collections.abc import Callable

from kurt2rt.core.tick import TickRecord
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.scheduler import Scheduler


class LoopPacer:
    """Runs the scheduler until `end`."""

    def __init__(self, scheduler: Scheduler[TickRecord], clock: Clock) -> None:
        self._scheduler = scheduler
        self._clock = clock
        self._shift_s = 0.0
        self._ended = False

    async def run(self, after_tick: Callable[[TickRecord], None]) -> None:
        """Tick until the end."""
        while not self._ended:
            await self._clock.wait_until(self._clock.now_s() + self._shift_s)
            await self._scheduler.run(None, after_tick)

    def shift(self, by_s: float) -> None:
        """Let all later ticks begin so much later in the period.

        The robot's cycle and ours are not in step, and how punctual the loop is depends on how they meet.
        """
        self._shift_s = by_s
        self._scheduler.end()

    def end(self) -> None:
        """No tick after the one that is due."""
        self._ended = True
        self._scheduler.end()
