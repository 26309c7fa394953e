"""Watchdog: a thread with its own clock that brakes when ticks cease."""

import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from hal.guard import Guard
from hal.guard_reason import GuardReason

POLL_S = 0.01
"""Time between two brakes, and longest lateness of the first one, in s."""


class Watchdog:
    """Thread that brakes through the guard if ticks cease: no `beat` for `ticks_ceased_s` (0.1 s for KURT2).

    It watches from the first beat on; the loop beats at the end of each tick.

    It cannot run in a stuck interpreter; there the controller's own watchdog stops the motors.
    """

    def __init__(self, guard: Guard, ticks_ceased_s: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._guard = guard
        self._ticks_ceased_s = ticks_ceased_s
        self._clock = clock
        self._beat_s: float | None = None
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    def beat(self) -> None:
        """Note the end of a tick; the first beat starts the watch."""
        self._beat_s = self._clock()

    def check(self, now_s: float) -> bool:
        """Return whether ticks have ceased at `now_s` of the watchdog's clock; False before the first beat."""
        beat_s = self._beat_s
        return beat_s is not None and not now_s - beat_s <= self._ticks_ceased_s

    @property
    def ticks_ceased(self) -> bool:
        """True when it watches and ticks have ceased by now."""
        return self.running and self.check(self._clock())

    @property
    def running(self) -> bool:
        """True while the thread watches."""
        return self._thread is not None and self._thread.is_alive()

    @property
    def thread(self) -> threading.Thread | None:
        """Thread of the watchdog; None before the start and after the end."""
        return self._thread

    def start(self) -> None:
        """Start the thread, which waits for the first beat. Raises RuntimeError if it runs already."""
        if self.running:
            raise RuntimeError("the watchdog runs already; start it once")
        self._beat_s = None
        self._stopping.clear()
        self._thread = threading.Thread(target=self._watch, name="watchdog", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop the thread and wait for its end; may be called twice."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.stop()

    def _pause_s(self) -> float:
        """Return the time until ticks can have ceased, in s: a look at each tick would take a twentieth of a tick."""
        beat_s = self._beat_s
        if beat_s is None:
            return POLL_S
        return min(max(POLL_S, beat_s + self._ticks_ceased_s - self._clock()), self._ticks_ceased_s)

    def _watch(self) -> None:
        while not self._stopping.wait(self._pause_s()):
            if self.check(self._clock()):
                # At every poll: a full queue may refuse one brake frame, and the controller forgets after 200 ms.
                self._guard.emergency_stop(GuardReason.TICKS_CEASED)
