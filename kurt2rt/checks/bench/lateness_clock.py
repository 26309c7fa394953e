"""Clock that records the lateness of its waits."""

from kurt2rt.platform.clock import Clock
from kurt2rt.platform.ledger import TickTimer


class LatenessClock:
    """Clock (kurt2rt.platform.clock.Clock) that records lateness in an exchangeable timer."""

    def __init__(self, clock: Clock) -> None:
        self.ledger: TickTimer | None = None
        """Destination of lateness; None: not recorded."""
        self._clock = clock

    def now_s(self) -> float:
        """Return monotonic time in seconds."""
        return self._clock.now_s()

    async def wait_until(self, deadline_s: float) -> None:
        """Wait for the deadline, and record how late the wait ended."""
        await self._clock.wait_until(deadline_s)
        if self.ledger is not None:
            self.ledger.begin(self._clock.now_s() - deadline_s)
            self.ledger.end()
