"""Latency of fsync on a disk."""

import os
import time
from typing import BinaryIO

_PAGE_BYTES = 4096


def fsync_ns(file: BinaryIO) -> int:
    """Return the ns until one more page of an unbuffered file is durable. Raises OSError."""
    file.write(bytes(_PAGE_BYTES))
    begun_ns = time.perf_counter_ns()
    os.fsync(file.fileno())
    return time.perf_counter_ns() - begun_ns
