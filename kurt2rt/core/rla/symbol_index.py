"""Nearest row of symbols, which are equal or not."""

import math

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.matching import validated_row
from kurt2rt.core.rla.near_conditions import NearestCondition


def hamming_distances(rows: NDArray[np.float64], symbols: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the number of places in which each of `rows` (n, d) differs from `symbols` (d,), shape (n,)."""
    distances: NDArray[np.float64] = (rows != symbols).sum(axis=1, dtype=np.float64)
    return distances


class SymbolIndex:
    """Conditions of symbols in one array, by age, with the methods of kurt2rt.core.rla.matching.ConditionIndex.

    A history changes once in seconds, so every search compares all rows: 200 rows of 12 symbols take about 10 us.
    """

    def __init__(self, dimensions: int) -> None:
        self._dimensions = dimensions
        self._rows = np.zeros((0, dimensions))

    def __len__(self) -> int:
        return len(self._rows)

    def append(self, condition: tuple[float, ...] | NDArray[np.float64]) -> None:
        """Append a condition of symbols (d,). Raises ValueError for a wrong length or a number that is not finite."""
        self.insert(len(self), condition)

    def insert(self, position: int, condition: tuple[float, ...] | NDArray[np.float64]) -> None:
        """Insert a condition (d,) before the one at `position`.

        Raises ValueError for a wrong length or a number that is not finite.
        """
        self._rows = np.insert(self._rows, position, validated_row(condition, self._dimensions), axis=0)

    def remove(self, position: int) -> None:
        """Remove the condition at `position`; later ones move up by one position."""
        self._rows = np.delete(self._rows, position, axis=0)

    def distances(self, situation: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distance of each condition to `situation` (d,), shape (n,), by age."""
        return hamming_distances(self._rows, situation)

    def nearest(self, situation: NDArray[np.float64]) -> NearestCondition | None:
        """Return position and distance of the condition nearest to `situation` (d,), and of the runner-up.

        Returns None without conditions; of equally near conditions the older one is nearer.
        """
        if not len(self):
            return None
        distances = self.distances(situation)
        best = int(distances.argmin())
        distance = float(distances[best])
        if len(self) == 1:
            return NearestCondition(best, distance, -1, math.inf)
        distances[best] = math.inf
        second = int(distances.argmin())
        return NearestCondition(best, distance, second, float(distances[second]))
