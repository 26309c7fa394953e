"""Bytes of situations with their actions, as snapshots of learners that keep such pairs."""

import json
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def pack(situations: NDArray[np.float64], actions: Sequence[str]) -> bytes:
    """Return the bytes of situations (n, d) and their n actions: a line of JSON, then the numbers."""
    return json.dumps(list(actions)).encode() + b"\n" + np.ascontiguousarray(situations, dtype="<f8").tobytes()


def unpack(data: bytes, dimensions: int) -> tuple[NDArray[np.float64], list[str]]:
    """Return the situations (n, d) and actions of bytes that `pack` made.

    `dimensions`: length d of a situation.

    Raises:
        ValueError: for bytes that are not such, or of situations of another length.
    """
    head, _, numbers = data.partition(b"\n")
    actions: list[str] = json.loads(head)
    return np.frombuffer(numbers, dtype="<f8").reshape(len(actions), dimensions).astype(np.float64), actions
