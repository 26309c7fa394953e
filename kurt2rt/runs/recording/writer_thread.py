"""Writer thread with a bounded queue of notes."""

import queue
import threading
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

_PERIOD_S = 0.1

NotedT = TypeVar("NotedT")


class WriterThread(Generic[NotedT]):
    """Queue of notes that never blocks the loop, and the thread that writes them ten times a second.

    Queueing takes about 1 us and never raises; a note without room is lost and counted.
    """

    def __init__(self, name: str, capacity: int, write: Callable[[], None]) -> None:
        """`capacity`: most notes that wait. `write`: the thread's body, which calls `wait_period` until True."""
        self.overruns = 0
        """Notes lost because the queue was full."""
        self._capacity = capacity
        # A SimpleQueue's put never waits for the thread at its other end, and a signal handler may interrupt it.
        self._waiting: queue.SimpleQueue[NotedT] = queue.SimpleQueue()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=write, name=name, daemon=True)
        self._started = False

    @property
    def started(self) -> bool:
        """Return whether the thread was started."""
        return self._started

    def __len__(self) -> int:
        """Return the number of waiting notes."""
        return self._waiting.qsize()

    def submit(self, noted: NotedT, held: int = 0) -> None:
        """Queue a note. `held`: notes taken already that still count against the capacity."""
        if self._waiting.qsize() + held < self._capacity:
            self._waiting.put(noted)
        else:
            self.overruns += 1

    def pop_all(self) -> Iterator[NotedT]:
        """Return the notes that wait now, oldest first."""
        return (self._waiting.get_nowait() for _ in range(self._waiting.qsize()))

    def start(self) -> None:
        """Start the thread; call it once."""
        self._started = True
        self._thread.start()

    def wait_period(self) -> bool:
        """Wait one period in the thread; return whether it must end."""
        return self._ending.wait(_PERIOD_S)

    def stop(self, patience_s: float) -> bool:
        """Ask the thread to end; return whether it did within `patience_s`."""
        self._ending.set()
        self._thread.join(patience_s)
        return not self._thread.is_alive()
