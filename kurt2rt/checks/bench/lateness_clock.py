"""A clock that notes how late its waits end, in whichever ledger is open."""

from kurt2rt.platform.clock import Clock
from kurt2rt.platform.ledger import TickTimer


class LatenessClock:
    """A clock (kurt2rt.platform.clock.Clock) of which one may ask how late a part of a run was."""

    def __init__(self, clock: Clock) -> None:
        self.ledger: TickTimer | None = None
        """Where lateness goes; None: it is not noted."""
        self._clock = clock

    def now_s(self) -> float:
        """Monotonic time in seconds."""
        return self._clock.now_s()

    async def wait_until(self, deadline_s: float) -> None:
        """Return at the deadline, or at once when it has passed."""
        await self._clock.wait_until(deadline_s)
        if self.ledger is not None:
            self.ledger.begin(self._clock.now_s() - deadline_s)
            self.ledger.end()
