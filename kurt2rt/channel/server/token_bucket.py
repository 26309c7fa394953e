"""A limit on how often something may happen."""

import time
from collections.abc import Callable


class TokenBucket:
    """Holds up to `capacity` tokens, full at the beginning; `rate_per_s` new ones come each second."""

    __slots__ = ("_capacity", "_now", "_rate_per_s", "_since_s", "_tokens")

    def __init__(self, capacity: float, rate_per_s: float, now: Callable[[], float] = time.monotonic) -> None:
        """`now` is a clock in seconds."""
        self._capacity = capacity
        self._rate_per_s = rate_per_s
        self._now = now
        self._tokens = capacity
        self._since_s = now()

    def take(self) -> bool:
        """Take one token; whether there was one."""
        now_s = self._now()
        self._tokens = min(self._capacity, self._tokens + (now_s - self._since_s) * self._rate_per_s)
        self._since_s = now_s
        if self._tokens < 1:
            return False
        self._tokens -= 1
        return True
