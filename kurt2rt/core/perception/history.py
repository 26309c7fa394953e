"""Ring buffer of feature vectors with exact running sums."""

import numpy as np
from numpy.typing import NDArray


class History:
    """Last `steps` feature vectors and their sum; whole numbers below 2**53, so the running sum never drifts."""

    def __init__(self, steps: int, width: int) -> None:
        self._ring = np.zeros((steps, width))
        self._sums = np.zeros(width)
        self._next = 0
        self._filled = 0
        self._divisor = np.ones(width)
        """Number of steps held, at least 1, for each value: numpy divides by a single number in twice the time."""

    @property
    def filled(self) -> int:
        """Number of steps held, at most the ring's length."""
        return self._filled

    def push(self, values: NDArray[np.float64]) -> None:
        """Append the features of one step, shape (width,), in the features' units; a full ring drops the oldest.

        Values must be whole numbers, as counts are, so that the sum stays exact.
        """
        row = self._ring[self._next]
        self._sums += values
        self._sums -= row  # zeros until the ring is full
        row[:] = values
        self._next += 1
        if self._next == len(self._ring):
            self._next = 0
        if self._filled < len(self._ring):
            self._set_filled(self._filled + 1)

    def fill(self, values: NDArray[np.float64]) -> None:
        """Set every step to `values`, shape (width,), in the features' units, as if the robot had always been here."""
        self._ring[:] = values
        self._sums[:] = len(self._ring) * values
        self._set_filled(len(self._ring))

    def clear(self) -> None:
        """Remove all steps."""
        self._ring[:] = 0
        self._sums[:] = 0
        self._next = 0
        self._set_filled(0)

    def average_into(self, out: NDArray[np.float64]) -> None:
        """Write the mean of all steps to `out`, float64 of shape (width,), in the features' units.

        Writes zeros before the first step.
        """
        np.divide(self._sums, self._divisor, out)

    def _set_filled(self, steps: int) -> None:
        self._filled = steps
        self._divisor.fill(max(steps, 1))
