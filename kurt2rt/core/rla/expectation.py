"""What is expected of one RLA: part E of it (paper, III.A.3)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Expectation:
    """The situation in which an RLA ended and another took over, as it was on average. Numbers are packed float64."""

    lesson: str
    """Command id of the lesson that gave the RLA its action: with another action it leads elsewhere."""
    count: int
    """How often it was seen to end so."""
    ticks: float
    """How long it drove, on average."""
    packed_mean: bytes
    packed_squares: bytes

    @property
    def mean(self) -> NDArray[np.float64]:
        """The expected situation, shape (d,), not weighted; of symbols the most frequent ones."""
        return np.frombuffer(self.packed_mean, dtype="<f8")

    @property
    def squares(self) -> NDArray[np.float64]:
        """Sum of squared deviations from the mean, shape (d,); of symbols how often another one came."""
        return np.frombuffer(self.packed_squares, dtype="<f8")

    @property
    def spread(self) -> NDArray[np.float64]:
        """Standard deviation of each feature, shape (d,); zeros before it ended twice."""
        spread: NDArray[np.float64] = np.sqrt(self.squares / max(self.count - 1, 1))
        return spread


def pack(values: NDArray[np.float64]) -> bytes:
    """Numbers as an expectation keeps them, to the last bit."""
    return np.asarray(values, dtype="<f8").tobytes()
