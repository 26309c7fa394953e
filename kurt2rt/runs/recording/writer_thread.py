"""The thread of what is written beside the loop, and what waits for it."""

import queue
import threading
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

_PERIOD_S = 0.1

NotedT = TypeVar("NotedT")


class WriterThread(Generic[NotedT]):
    """Takes notes without waiting, and runs a writer that looks for them ten times a second.

    To put a note takes about a microsecond and never raises; one that finds no room is lost and counted.
    """

    def __init__(self, name: str, capacity: int, write: Callable[[], None]) -> None:
        """`capacity`: most notes that wait. `write`: the thread's body, which calls `wait_period` until True."""
        self.overruns = 0
        """Notes that were lost because too many waited."""
        self._capacity = capacity
        # A SimpleQueue's put never waits for the thread at its other end, and a signal handler may interrupt it.
        self._waiting: queue.SimpleQueue[NotedT] = queue.SimpleQueue()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=write, name=name, daemon=True)
        self._started = False

    @property
    def started(self) -> bool:
        """Whether it was."""
        return self._started

    def __len__(self) -> int:
        """Notes that wait."""
        return self._waiting.qsize()

    def submit(self, noted: NotedT, held: int = 0) -> None:
        """Have it wait. `held`: so many that were taken already count as waiting still."""
        if self._waiting.qsize() + held < self._capacity:
            self._waiting.put(noted)
        else:
            self.overruns += 1

    def pop_all(self) -> Iterator[NotedT]:
        """All that waits now, the oldest first."""
        return (self._waiting.get_nowait() for _ in range(self._waiting.qsize()))

    def start(self) -> None:
        """Begin; once only."""
        self._started = True
        self._thread.start()

    def wait_period(self) -> bool:
        """In the thread: wait for the next round; whether that is the last one."""
        return self._ending.wait(_PERIOD_S)

    def stop(self, patience_s: float) -> bool:
        """Ask it to end; whether it did within its time."""
        self._ending.set()
        self._thread.join(patience_s)
        return not self._thread.is_alive()
