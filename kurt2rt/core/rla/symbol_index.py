"""Nearest row of symbols: symbols are equal or not, and nothing lies between them."""

import math

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.matching import NearestCondition, validated_row


def hamming_distances(rows: NDArray[np.float64], symbols: NDArray[np.float64]) -> NDArray[np.float64]:
    """In how many places each of `rows` (n, d) differs from `symbols` (d,), shape (n,)."""
    distances: NDArray[np.float64] = (rows != symbols).sum(axis=1, dtype=np.float64)
    return distances


def edit_distances(rows: NDArray[np.float64], symbols: NDArray[np.float64]) -> NDArray[np.float64]:
    """How many insertions, deletions and changes make each of `rows` (n, d) of `symbols` (d,), shape (n,).

    Levenshtein's table, a line at a time for all rows at once. Within a line each entry hangs on the one before it, by
    one insertion more: measured from that slope, the best so far is a running minimum.
    """
    count, length = rows.shape
    places = np.ascontiguousarray(rows.T)
    slope = np.arange(length + 1, dtype=np.int16)[:, np.newaxis]
    line = np.repeat(slope, count, axis=1)
    following = np.empty_like(line)
    for symbol in symbols:
        np.add(line, 1, out=following)
        changed = line[:-1] + (places != symbol)
        np.minimum(following[1:], changed, out=following[1:])
        following -= slope
        np.minimum.accumulate(following, axis=0, out=line)
        line += slope
    distances: NDArray[np.float64] = line[-1].astype(np.float64)
    return distances


class SymbolIndex:
    """Conditions made of symbols in one array, in order of age; used like kurt2rt.core.rla.matching.ConditionIndex.

    A history changes every few seconds, so all are compared anew: for 200 of 12 symbols some 10 us in places that
    differ, some 200 us in edits.
    """

    def __init__(self, dimensions: int, *, edits: bool) -> None:
        """`edits`: distances count insertions, deletions and changes; else places that differ."""
        self._dimensions = dimensions
        self._distances = edit_distances if edits else hamming_distances
        self._rows = np.zeros((0, dimensions))

    def __len__(self) -> int:
        return len(self._rows)

    def append(self, condition: tuple[float, ...] | NDArray[np.float64]) -> None:
        """Add a condition behind all others. Raises ValueError for a wrong length or a number that is not finite."""
        self.insert(len(self), condition)

    def insert(self, position: int, condition: tuple[float, ...] | NDArray[np.float64]) -> None:
        """Add a condition before that at `position`: it is older than those behind. Raises as `append`."""
        self._rows = np.insert(self._rows, position, validated_row(condition, self._dimensions), axis=0)

    def remove(self, position: int) -> None:
        """Take one condition out; those behind it move up."""
        self._rows = np.delete(self._rows, position, axis=0)

    def distances(self, situation: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance of each condition to `situation` (d,), shape (n,), in order of age."""
        return self._distances(self._rows, situation)

    def nearest(self, situation: NDArray[np.float64]) -> NearestCondition | None:
        """Nearest condition to `situation` (d,), of equal ones the older, and the one behind; None if there is none."""
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
