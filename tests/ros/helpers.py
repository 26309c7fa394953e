"""Places to listen at on this machine, and waiting for other threads."""

import socket
import time
from collections.abc import Callable

from tests.patience import PATIENCE_S


def free_locator() -> str:
    """Return a locator of this machine at which nothing listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def wait_for(condition: Callable[[], bool], *, at_most_s: float = PATIENCE_S) -> None:
    """Return as soon as a condition holds that another thread brings about; the limit only ends a broken test."""
    deadline_s = time.monotonic() + at_most_s
    while not condition():
        assert time.monotonic() < deadline_s, "waited in vain"
        time.sleep(0.002)
