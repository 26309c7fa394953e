"""Temporary signal handlers, restored afterwards."""

import signal
from collections.abc import Callable, Mapping
from types import FrameType, TracebackType
from typing import Self

Handler = Callable[[int, FrameType | None], object] | signal.Handlers
"""Handler that Python calls in the main thread, between two bytecodes, even while an earlier handler runs."""


class SignalHandlers:
    """Context manager that installs signal handlers and restores the previous ones at its end."""

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
        """Install the handlers. Raises ValueError outside the main thread."""
        for number, handler in self._handlers.items():
            # None stands for a handler that Python did not install: it cannot be restored.
            self._before[number] = signal.signal(number, handler) or signal.SIG_DFL

    def restore(self) -> None:
        """Restore the previous handlers; may be called from a handler."""
        for number, before in self._before.items():
            signal.signal(number, before)
