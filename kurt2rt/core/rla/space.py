"""Space of one level: dimensions, radius, weights and metric of its distances."""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Metric = Literal["euclidean", "hamming"]
"""Distance between two points: Euclidean for measured features; for symbols the number of places that differ."""


class Space(NamedTuple):
    """Dimensions, radius, weights and metric of the distances of one level."""

    dimensions: int
    radius: float
    """Confidence radius of RLAs without an own radius."""
    weights: NDArray[np.float64] | None = None
    """Weight of each feature in a distance, shape (dimensions,); None: all 1. Symbols have no weights."""
    metric: Metric = "euclidean"
