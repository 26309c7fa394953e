"""Ring buffer of the last steps with exact running sums."""

import numpy as np
from numpy.typing import NDArray


class History:
    """The last `steps` feature vectors and their sum.

    Values are integers (counts), so the running sum never drifts: after any number of steps it is the sum of what the
    ring holds, bit for bit.
    """

    def __init__(self, steps: int, width: int) -> None:
        self._ring = np.zeros((steps, width), dtype=np.int64)
        self._sums = np.zeros(width, dtype=np.int64)
        self._next = 0
        self._filled = 0

    @property
    def filled(self) -> int:
        """Number of steps held, at most the ring's length."""
        return self._filled

    def push(self, values: NDArray[np.int64]) -> None:
        """Take in one step; the oldest leaves when the ring is full. `values`: shape (width,), integers."""
        row = self._ring[self._next]
        self._sums += values
        self._sums -= row  # zeros until the ring is full
        row[:] = values
        self._next += 1
        if self._next == len(self._ring):
            self._next = 0
        if self._filled < len(self._ring):
            self._filled += 1

    def fill(self, values: NDArray[np.int64]) -> None:
        """Hold `values` in every step, as if the robot had been here all the time."""
        self._ring[:] = values
        self._sums[:] = len(self._ring) * values
        self._filled = len(self._ring)

    def clear(self) -> None:
        """Hold no step any more."""
        self._ring[:] = 0
        self._sums[:] = 0
        self._next = self._filled = 0

    def average_into(self, out: NDArray[np.float64]) -> None:
        """Write the average of the steps held into `out`, shape (width,); zeros before the first step."""
        np.divide(self._sums, max(self._filled, 1), out=out)
