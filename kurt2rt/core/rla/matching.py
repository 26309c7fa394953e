"""Nearest condition: one matrix product in float32, then an exact answer in float64."""

import math
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

_sum = np.add.reduce
"""Adds up pairwise, in an order that numpy itself gives (its loops_utils), whatever the processor has."""

_Number = TypeVar("_Number", np.float32, np.float64)

_DOUBT = 2 * float(np.finfo(np.float32).eps)
"""Each rough score is a sum of d products of numbers rounded to float32: wrong by less than (d + 4) times the unit
round-off (eps / 2) of at most |c||s| + |c|^2 / 2. Two scores are compared, so twice; the rest is slack for this bound's
own rounding."""

_BRUTE_FORCE_DOUBT = 1e-8
"""Very far from all conditions float64 itself sees ties where scores differ: its round-off is a share
of the whole reach squared, 2e-16 where _DOUBT is 2e-7 of the smaller product."""

_SMALLEST_NORM = 1e-15
"""Norms count as at least this long in the doubt: products of shorter ones underflow in float32."""

_FLOAT32_REACH = 1e18
"""From here on the squares that make a score could leave float32's range: no rough look then."""


_AT_ONCE = 8192
"""Numbers of a piece of the work: they stay in the cache, and need no memory that is asked of the machine anew."""


class NearestCondition(NamedTuple):
    """The nearest condition and the one behind it."""

    position: int
    distance: float
    """Euclidean distance, float64, exactly as `exact_distances` gives it."""
    runner_up: int
    """The second nearest; -1 where there is only one condition."""
    runner_up_distance: float
    """As `distance`; infinite where there is no runner-up."""


def exact_distances(conditions: NDArray[np.float64], situation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Euclidean distance of each row of `conditions` (n, d) to `situation` (d,), shape (n,): what all else obeys."""
    squares = np.empty(len(conditions))
    rows = max(1, _AT_ONCE // max(1, situation.size))
    for first in range(0, len(conditions), rows):
        difference = conditions[first : first + rows] - situation
        _sum(np.square(difference, out=difference), axis=1, out=squares[first : first + rows])
    distances: NDArray[np.float64] = np.sqrt(squares, out=squares)
    return distances


def exact_square(difference: NDArray[np.float64]) -> float:
    """Sum of squares (d,), the same to the last bit on every processor, and as `exact_distances` adds up a row.

    A dot product is not: it is OpenBLAS's, which has another order of adding for each kind of processor.
    """
    return float(_sum(difference * difference))


def validated_row(condition: tuple[float, ...] | NDArray[np.float64], dimensions: int) -> NDArray[np.float64]:
    """A condition as an array (d,). Raises ValueError for a wrong length or a number that is not finite."""
    row = np.array(condition, dtype=np.float64)
    if row.shape != (dimensions,):
        raise ValueError(f"condition has {row.size} values, this system matches {dimensions}")
    if not np.isfinite(row).all():
        raise ValueError("condition holds a value that is not finite")
    return row


class ConditionIndex:
    """All conditions in one contiguous array, in order of age.

    |c|^2/2 - c.s orders the rows as the distance does, and one product computes it for all. It runs in float32, half
    the memory of float64 and so twice as fast for many RLAs; every row that the rounding error could have hidden is
    compared again in float64. So the winner is the one that a float64 brute force names, and of equal ones the older.
    """

    def __init__(self, dimensions: int) -> None:
        self._dimensions = dimensions
        self._count = 0
        self._exact = np.zeros((64, dimensions))
        self._rough = np.zeros((64, dimensions), dtype=np.float32)
        self._half_squares = np.zeros(64, dtype=np.float32)
        self._norms = np.zeros(64)
        self._pair, self._squares = np.empty((2, dimensions)), np.empty(2)
        self._largest_norm = _SMALLEST_NORM
        self._update_views()

    def __len__(self) -> int:
        return self._count

    def append(self, condition: tuple[float, ...] | NDArray[np.float64]) -> None:
        """Add a condition behind all others. Raises ValueError for a wrong length or a number that is not finite."""
        self.insert(self._count, condition)

    def insert(self, position: int, condition: tuple[float, ...] | NDArray[np.float64]) -> None:
        """Add a condition before that at `position`: it is older than those behind. Raises as `append`."""
        row = validated_row(condition, self._dimensions)
        if self._count == len(self._exact):
            self._grow()
        for array in (self._exact, self._rough, self._half_squares, self._norms):
            array[position + 1 : self._count + 1] = array[position : self._count]
        square = float(row @ row)
        self._exact[position] = row
        with np.errstate(over="ignore"):  # beyond _FLOAT32_REACH nobody looks at these two
            self._rough[position] = row
            self._half_squares[position] = 0.5 * square
        self._norms[position] = norm = math.sqrt(square)
        self._largest_norm = max(self._largest_norm, norm)
        self._count += 1
        self._update_views()

    def remove(self, position: int) -> None:
        """Take one condition out; those behind it move up."""
        norm = float(self._norms[position])
        for array in (self._exact, self._rough, self._half_squares, self._norms):
            array[position : self._count - 1] = array[position + 1 : self._count]
        self._count -= 1
        if norm >= self._largest_norm:  # a far one that was taken back leaves no doubt behind
            self._largest_norm = float(self._norms[: self._count].max(initial=_SMALLEST_NORM))
        self._update_views()

    def distances(self, situation: NDArray[np.float64]) -> NDArray[np.float64]:
        """Exact distance of each condition to `situation` (d,), shape (n,), in order of age: not for every tick."""
        return exact_distances(self._exact[: self._count], situation)

    def nearest(self, situation: NDArray[np.float64]) -> NearestCondition | None:
        """Nearest condition to `situation` (d,) and the one behind it; None when there is none."""
        if self._count == 0:
            return None
        if self._count == 1:
            return NearestCondition(0, self._distance(0, situation), -1, math.inf)
        square = float(situation.dot(situation))
        reach = math.sqrt(square) + self._largest_norm
        if not reach < _FLOAT32_REACH:  # true for NaN as well
            return self._nearest_exact(situation, np.arange(self._count))
        scores = self._scores
        np.dot(self._rough_rows, situation.astype(np.float32), out=scores)
        np.subtract(self._half_squares_rows, scores, out=scores)
        best = int(scores.argmin())
        best_score = scores.item(best)
        scores[best] = math.inf
        second = int(scores.argmin())
        second_score = scores.item(second)
        scores[second] = math.inf
        third_score = scores.item(int(scores.argmin()))
        doubt = _DOUBT * (self._dimensions + 4) * reach * (self._largest_norm + _BRUTE_FORCE_DOUBT * reach)
        if second_score - best_score > doubt and third_score - second_score > doubt:
            return self._nearest_two(best, second, situation)
        scores[best], scores[second] = best_score, second_score
        return self._nearest_exact(situation, np.flatnonzero(scores <= second_score + doubt))

    def _nearest_exact(self, situation: NDArray[np.float64], candidates: NDArray[np.intp]) -> NearestCondition:
        distances = exact_distances(self._exact[candidates], situation)
        first = int(distances.argmin())  # the first of equal ones: candidates are in order of age
        winner, distance = int(candidates[first]), float(distances[first])
        distances[first] = math.inf
        second = int(distances.argmin())
        return NearestCondition(winner, distance, int(candidates[second]), float(distances[second]))

    def _distance(self, position: int, situation: NDArray[np.float64]) -> float:
        """`exact_distances` for one row."""
        return math.sqrt(exact_square(self._exact[position] - situation))

    def _nearest_two(self, best: int, second: int, situation: NDArray[np.float64]) -> NearestCondition:
        """`exact_distances` for two rows: the same sums, at half of what `_distance` would cost twice."""
        rows, squares = self._pair, self._squares
        np.subtract(self._exact[best], situation, rows[0])
        np.subtract(self._exact[second], situation, rows[1])
        np.multiply(rows, rows, rows)
        _sum(rows, 1, out=squares)
        return NearestCondition(best, math.sqrt(squares.item(0)), second, math.sqrt(squares.item(1)))

    def _grow(self) -> None:
        self._exact = _doubled(self._exact)
        self._rough = _doubled(self._rough)
        self._half_squares = _doubled(self._half_squares)
        self._norms = _doubled(self._norms)

    def _update_views(self) -> None:
        self._rough_rows = self._rough[: self._count]
        self._half_squares_rows = self._half_squares[: self._count]
        self._scores = np.empty(self._count, dtype=np.float32)


def _doubled(array: NDArray[_Number]) -> NDArray[_Number]:
    """The same rows with room behind them that is not filled: it costs its time when it is, not in this tick."""
    longer = np.empty((2 * len(array), *array.shape[1:]), dtype=array.dtype)
    longer[: len(array)] = array
    return longer
