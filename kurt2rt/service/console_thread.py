"""Prints outside the loop: a terminal that blocks must not hold up a tick."""

import queue
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self

_CAPACITY = 200
_LAST_LINES_S = 1.0


class ConsoleThread:
    """A thread that runs what it is given, in order. When it cannot keep up, what comes is dropped and counted."""

    def __init__(self, patience_s: Callable[[float], float] = lambda most_s: most_s) -> None:
        """`patience_s`: how long it may be waited for at the end, of what it would like."""
        self._remaining_s = patience_s
        self._jobs: queue.Queue[Callable[[], None] | None] = queue.Queue(_CAPACITY)
        self._thread = threading.Thread(target=self._run, name="printer", daemon=True)
        self.dropped = 0

    def submit(self, job: Callable[[], None]) -> None:
        """Run `job` soon; never waits."""
        try:
            self._jobs.put_nowait(job)
        except queue.Full:
            self.dropped += 1

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._jobs.put(None, timeout=self._remaining_s(_LAST_LINES_S))
        except queue.Full:
            return  # whoever reads the terminal has stopped reading; the thread ends with the process
        self._thread.join(timeout=self._remaining_s(_LAST_LINES_S))

    def _run(self) -> None:
        while (job := self._jobs.get()) is not None:
            job()
