"""Time for which this process was ready to run and had no processor."""

from contextlib import suppress
from pathlib import Path

_THREADS = Path("/proc/self/task")
_NANOSECONDS = 1e9


def run_delay_s() -> float:
    """Return the time in s that the present threads have waited for a processor; 0 where the kernel does not tell."""
    total_ns = 0
    with suppress(OSError):
        for thread in _THREADS.iterdir():
            with suppress(OSError):  # it has just ended
                total_ns += int((thread / "schedstat").read_text().split()[1])
    return total_ns / _NANOSECONDS
