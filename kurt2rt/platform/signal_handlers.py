"""Who hears signals for a while, and gives them back."""

import signal
from collections.abc import Callable, Mapping
from types import FrameType, TracebackType
from typing import Self

Handler = Callable[[int, FrameType | None], object] | signal.Handlers
"""What Python calls in the main thread, between two of its steps: it may come at any place of it, and while it is busy
with one before."""


class SignalHandlers:
    """Has signals handled otherwise, as a context manager; at its end they are handled as they were before."""

    def __init__(self, handlers: Mapping[signal.Signals, Handler]) -> None:
        self._handlers = handlers
        self._before: dict[signal.Signals, signal._HANDLER] = {}

    def __enter__(self) -> Self:
        self.install()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.restore()

    def install(self) -> None:
        """Begin to. Raises ValueError outside the main thread."""
        for number, handler in self._handlers.items():
            # None is a handler that is not Python's: it cannot be given back.
            self._before[number] = signal.signal(number, handler) or signal.SIG_DFL

    def restore(self) -> None:
        """Hear nothing any more, from now on; also out of a handler, so that the next signal is handled as before."""
        for number, before in self._before.items():
            signal.signal(number, before)
