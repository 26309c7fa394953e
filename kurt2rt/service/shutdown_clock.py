"""Time since the signal that ends the program: a busy machine that gives it no processor is no disk that hangs."""

import math
import time
from collections.abc import Callable

from kurt2rt.platform.run_delay import run_delay_s

_MOST = 20.0
"""Greatest slowness that is believed: delays of several threads at once are counted together."""

_TRUSTED_AFTER_S = 0.1
"""Time after which the slowness since `start` counts as much as that before."""


class ShutdownClock:
    """Clock that stands while threads of this process wait for a processor."""

    def __init__(
        self,
        now_s: Callable[[], float] = time.monotonic,
        delayed_s: Callable[[], float] = run_delay_s,
        worked_s: Callable[[], float] = time.process_time,
    ) -> None:
        """Wait for `start`.

        Args:
            now_s: returns the present in s.
            delayed_s: returns how long threads have waited for a processor so far, in s.
            worked_s: returns how long they have had one, in s.
        """
        self._now_s, self._delayed_s, self._worked_s = now_s, delayed_s, worked_s
        self._began_s = math.inf
        self._delayed_before_s = 0.0
        self._slowness_before = 1.0

    @property
    def started(self) -> bool:
        """Return whether `start` was called."""
        return self._began_s < math.inf

    def start(self) -> None:
        """Begin at 0."""
        self._delayed_before_s = self._delayed_s()
        self._slowness_before = min(1.0 + self._delayed_before_s / max(self._worked_s(), 1e-3), _MOST)
        self._began_s = self._now_s()

    def left_s(self, until_s: float, most_s: float = math.inf) -> float:
        """Return the real time in s until this clock shows `until_s`, if the machine stays as busy as it was so far.

        `most_s`: longest time in s of this clock. The result is 0 or more, and `most_s` before `start`.
        """
        if not self.started:
            return most_s
        real_s = self._now_s() - self._began_s
        delayed_s = max(self._delayed_s() - self._delayed_before_s, 0.0)  # a thread that ended took its delay along
        own_s = max(real_s - delayed_s, real_s / _MOST)
        slowness = (real_s + _TRUSTED_AFTER_S * self._slowness_before) / (own_s + _TRUSTED_AFTER_S)
        return max(0.0, min(until_s - own_s, most_s)) * slowness
