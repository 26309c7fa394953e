"""Thread that prints, because a terminal that blocks must not delay a tick."""

import queue
import threading
from collections.abc import Callable
from typing import Self

_CAPACITY = 200
_LAST_LINES_S = 1.0


class ConsoleThread:
    """Thread that prints, so that a blocked terminal never delays the loop: it runs submitted jobs in order.

    Jobs are dropped and counted while its queue is full.
    """

    def __init__(self, remaining_s: Callable[[float], float] = lambda most_s: most_s) -> None:
        """`remaining_s`: returns the time that is left for a wait of the given length, in s."""
        self._remaining_s = remaining_s
        self._jobs: queue.Queue[Callable[[], None] | None] = queue.Queue(_CAPACITY)
        self._thread = threading.Thread(target=self._run, name="printer", daemon=True)
        self.dropped = 0

    def submit(self, job: Callable[[], None]) -> None:
        """Queue `job`, or drop it if the queue is full; never waits."""
        try:
            self._jobs.put_nowait(job)
        except queue.Full:
            self.dropped += 1

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._jobs.put(None, timeout=self._remaining_s(_LAST_LINES_S))
        except queue.Full:
            return  # the terminal blocks; the thread ends with the process
        self._thread.join(timeout=self._remaining_s(_LAST_LINES_S))

    def _run(self) -> None:
        while (job := self._jobs.get()) is not None:
            job()
