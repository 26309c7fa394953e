"""Ctrl-C while a command is not under way yet."""

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from config.errors import ExitCode


@contextmanager
def end_at_interrupt() -> Iterator[None]:
    """End the process at the first Ctrl-C in this block, with exit code 130: for imports, before anything is open.

    A KeyboardInterrupt would come up in the middle of a package, which may print it or take it for an error of its own.
    Another handler that the program has, and a SIGINT that it ignores, stay.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _end)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _end(_number: int, _frame: FrameType | None) -> None:
    os._exit(ExitCode.INTERRUPTED)
