"""Loop of an open robot with an adjustable phase against the simulated controller's cycle."""

from collections.abc import Callable

from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.scheduler import Scheduler


class LoopPacer:
    """Loop that runs the scheduler until `end`."""

    def __init__(self, scheduler: Scheduler[TickRecord], clock: Clock) -> None:
        self._scheduler = scheduler
        self._clock = clock
        self._shift_s = 0.0
        self._ended = False

    async def run(self, after_tick: Callable[[TickRecord], None]) -> None:
        """Run ticks until `end` is called; a `shift` meanwhile delays the later ones.

        Call this once: after `end` it returns at once. `after_tick` gets the record of each tick; its time
        counts against the period.
        """
        while not self._ended:
            await self._clock.wait_until(self._clock.now_s() + self._shift_s)
            await self._scheduler.run(None, after_tick)

    def shift(self, by_s: float) -> None:
        """Delay all later ticks by `by_s` within the period.

        Lateness depends on the phase of the two independent cycles.
        """
        self._shift_s = by_s
        self._scheduler.end()

    def end(self) -> None:
        """End after the present tick."""
        self._ended = True
        self._scheduler.end()
