"""Temporary signal handlers, restored afterwards."""

import signal
from collections.abc import Callable, Mapping
from types import FrameType
from typing import Self

Handler = Callable[[int, FrameType | None], object] | signal.Handlers
"""Handler that Python calls in the main thread, between two bytecodes, even while an earlier handler runs."""


def heeded_signals(*numbers: signal.Signals) -> tuple[signal.Signals, ...]:
    """Return the signals of `numbers` that this process does not ignore.

    nohup starts a program with SIGHUP ignored, a shell one in the background with SIGINT and SIGQUIT. They stay so.
    """
    return tuple(each for each in numbers if signal.getsignal(each) is not signal.SIG_IGN)


class SignalHandlers:
    """Context manager that installs handlers of heeded signals and restores the previous ones at its end."""

    def __init__(self, handlers: Mapping[signal.Signals, Handler]) -> None:
        self._handlers = handlers
        self._before: dict[signal.Signals, signal._HANDLER] = {}

    def __enter__(self) -> Self:
        self.install()
        return self

    def __exit__(self, *_: object) -> None:
        self.restore()

    def install(self) -> None:
        """Install the handlers. Raises ValueError outside the main thread."""
        for number in heeded_signals(*self._handlers):
            # None stands for a handler that Python did not install: it cannot be restored.
            self._before[number] = signal.signal(number, self._handlers[number]) or signal.SIG_DFL

    def restore(self) -> None:
        """Restore the previous handlers; may be called from a handler."""
        for number, before in self._before.items():
            signal.signal(number, before)
