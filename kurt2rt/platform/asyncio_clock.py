"""Clock that waits by the event loop alone."""

import asyncio
import time


class AsyncioClock:
    """Waits by `asyncio.sleep`, as the reference for better clocks."""

    def now_s(self) -> float:
        """Return the monotonic time in s."""
        return time.monotonic()

    async def wait_until(self, deadline_s: float) -> None:
        """Return at the deadline, rounded up to the event loop's whole milliseconds."""
        await asyncio.sleep(deadline_s - time.monotonic())
