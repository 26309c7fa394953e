"""Rate limits by time, and by ticks for each device."""

import time
from collections.abc import Callable


class TokenBucket:
    """Bucket of up to `capacity` tokens, full at the beginning, refilled by `rate_per_s` tokens a second."""

    __slots__ = ("_capacity", "_now", "_rate_per_s", "_since_s", "_tokens")

    def __init__(self, capacity: float, rate_per_s: float, now: Callable[[], float] = time.monotonic) -> None:
        """`now` is a clock in seconds."""
        self._capacity = capacity
        self._rate_per_s = rate_per_s
        self._now = now
        self._tokens = capacity
        self._since_s = now()

    def acquire(self) -> bool:
        """Remove a token if there is one; return whether there was one. It never waits."""
        now_s = self._now()
        self._tokens = min(self._capacity, self._tokens + (now_s - self._since_s) * self._rate_per_s)
        self._since_s = now_s
        if self._tokens < 1:
            return False
        self._tokens -= 1
        return True


class PerDeviceRateLimit:
    """Limit for each device: `most` requests at once, and one more every `every_ticks` ticks."""

    def __init__(self, most: int, every_ticks: int) -> None:
        self._most = most
        self._every_ticks = every_ticks
        self._full_at: dict[str, int] = {}
        """Tick at which a device has its full allowance again."""

    def acquire(self, device: str, tick: int) -> bool:
        """Count a request of a device; return whether it is within the limit."""
        full_at = max(self._full_at.get(device, tick), tick) + self._every_ticks
        if full_at > tick + self._most * self._every_ticks:
            return False
        self._full_at[device] = full_at
        return True
