"""What distances of one level are measured in."""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Metric = Literal["euclidean", "hamming", "edit"]
"""How far apart two points are: of features that measure something, the Euclidean distance; of symbols, which are
equal or not, in how many places they differ, or how many insertions, deletions and changes make one of the other."""


class Space(NamedTuple):
    """What distances of one level are measured in."""

    dimensions: int
    radius: float
    """Confidence radius of RLAs that have none of their own."""
    weights: NDArray[np.float64] | None = None
    """Shape (dimensions,): how much each feature counts in a distance; None: all count 1. Symbols have none."""
    metric: Metric = "euclidean"
