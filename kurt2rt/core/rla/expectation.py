"""Expectation of one RLA: part E of it (paper, section III.A.3)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Expectation:
    """Mean situation in which an RLA ended and another one took over. Arrays are packed float64."""

    lesson: str
    """Command id of the lesson that gave the RLA its action; another action has another expectation."""
    count: int
    """Number of ends so far."""
    ticks: float
    """Mean duration in ticks."""
    packed_mean: bytes
    packed_squares: bytes

    @property
    def mean(self) -> NDArray[np.float64]:
        """Expected situation, shape (d,), not weighted; of symbols the most frequent ones."""
        return np.frombuffer(self.packed_mean, dtype="<f8")

    @property
    def squares(self) -> NDArray[np.float64]:
        """Sum of squared deviations from the mean, shape (d,); of symbols the number of other symbols."""
        return np.frombuffer(self.packed_squares, dtype="<f8")

    @property
    def spread(self) -> NDArray[np.float64]:
        """Standard deviation of each feature, shape (d,); zeros before the second end."""
        spread: NDArray[np.float64] = np.sqrt(self.squares / max(self.count - 1, 1))
        return spread


def pack(values: NDArray[np.float64]) -> bytes:
    """Return the bytes of an array (d,) as an expectation stores them, to the last bit."""
    return np.asarray(values, dtype="<f8").tobytes()
