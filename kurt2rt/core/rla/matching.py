"""Search for the nearest condition: one matrix product in float32, then exact distances in float64."""

import math
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from hal import points

pairwise_sum = np.add.reduce
"""Pairwise sum, in an order that numpy fixes (loops_utils) for all processors."""


class NearestCondition(NamedTuple):
    """Result of a search: positions of the nearest condition and the runner-up, and their distances."""

    position: int
    distance: float
    """Euclidean distance in float64, equal to `exact_distances` to the last bit."""
    runner_up: int
    """Second nearest; -1 if there is only one condition."""
    runner_up_distance: float
    """Distance of the runner-up; infinite without a runner-up."""


class NearConditions:
    """Some conditions, at least two, and a situation from which all others are farther away than a bound.

    By the triangle inequality a condition comes nearer to a situation by no more than the situation has moved. So these
    conditions hold the two nearest ones, as long as both are nearer than the bound less that way.
    """

    def __init__(
        self,
        positions: NDArray[np.intp],
        conditions: NDArray[np.float64],
        situation: NDArray[np.float64],
        others_beyond: float,
    ) -> None:
        """Keep a copy of the conditions.

        Args:
            positions: of these conditions among all, ascending, (n,).
            conditions: these, (n, d).
            situation: (d,), in counts of the basic level.
            others_beyond: bound of the distances of all others to the situation, in its unit.
        """
        self._positions: list[int] = positions.tolist()
        self._rows = np.concatenate((conditions, situation[np.newaxis]))
        self._differences = np.empty_like(self._rows)
        self._distances = np.empty(len(self._rows))
        self._others_beyond = others_beyond
        self.has_served = False
        """Whether a situation was near enough so far."""

    def nearest(self, situation: NDArray[np.float64]) -> NearestCondition | None:
        """Return the condition nearest to `situation` (d,), and the runner-up; None if others may be as near.

        Of equally near conditions the older one is nearer.
        """
        differences, distances = self._differences, self._distances
        np.subtract(self._rows, situation, differences)
        np.multiply(differences, differences, differences)
        pairwise_sum(differences, 1, out=distances)
        *away, moved = np.sqrt(distances, distances).tolist()
        first, second = sorted(away)[:2]
        if not second < self._others_beyond - moved:  # true for NaN as well
            return None
        self.has_served = True
        best = away.index(first)
        runner_up = away.index(second, best + 1 if second == first else 0)
        return NearestCondition(self._positions[best], first, self._positions[runner_up], second)


def bound_of_others(score: float, error: float, square: float, reach: float) -> float:
    """Return a distance within which no condition of at least this score lies, in the unit of a distance.

    Args:
        score: |c|^2/2 - c.s of a condition c and the situation s.
        error: bound of the score's error.
        square: |s|^2.
        reach: sum of |s| and the largest |c|; the bound is less by its round-off.
    """
    return math.sqrt(max(0.0, square + 2.0 * (score - error))) - 1e-9 * reach


_Number = TypeVar("_Number", np.float32, np.float64)

_ERROR_FACTOR = 2 * float(np.finfo(np.float32).eps)
"""Error bound of a comparison of two scores, per (dimension + 4). A score sums d products of float32 numbers: its
error is less than (d + 4) * eps / 2 * (|c||s| + |c|^2 / 2). Two scores double it; the rest is slack for rounding."""

_FLOAT64_FACTOR = 1e-8
"""Part of the bound for float64: very far from all conditions its round-off, 2e-16 of the reach squared, makes ties
of different scores."""

_SMALLEST_NORM = 1e-15
"""Least norm in the bound: products of shorter vectors underflow in float32."""

_FLOAT32_REACH = 1e18
"""Largest |c| + |s| for float32 scores: beyond it their squares can overflow."""


_CHUNK = 8192
"""Numbers per chunk of exact distances: a chunk stays in the cache."""


_NEAR = 8
"""Conditions that are tried first. With 8 a robot that drives finds the nearest among them in 97 of 100 ticks, with 4
in 93, with 16 in 98."""

_SEARCHES = 16
"""Searches without a try, after conditions that served no situation: situations that do not follow one another."""


def exact_distances(conditions: NDArray[np.float64], situation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the Euclidean distance of each row of `conditions` (n, d) to `situation` (d,), shape (n,)."""
    squares = np.empty(len(conditions))
    rows = max(1, _CHUNK // max(1, situation.size))
    for first in range(0, len(conditions), rows):
        difference = conditions[first : first + rows] - situation
        pairwise_sum(np.square(difference, out=difference), axis=1, out=squares[first : first + rows])
    distances: NDArray[np.float64] = np.sqrt(squares, out=squares)
    return distances


def exact_square(difference: NDArray[np.float64]) -> float:
    """Return the sum of squares of a vector (d,), in counts squared of the basic level, equal on every processor.

    A dot product is not equal: OpenBLAS adds in another order on each kind of processor.
    """
    return float(pairwise_sum(difference * difference))


def validated_row(condition: tuple[float, ...] | NDArray[np.float64], dimensions: int) -> NDArray[np.float64]:
    """Return a condition as an array (d,). Raises ValueError for a wrong length or a number that is not finite."""
    row = np.array(condition, dtype=np.float64)
    if row.shape != (dimensions,):
        raise ValueError(f"condition has {row.size} values, this system matches {dimensions}")
    if not np.isfinite(row).all():
        raise ValueError("condition holds a value that is not finite")
    return row


class ConditionIndex:
    """Conditions in one contiguous array, oldest first.

    |c|^2/2 - c.s orders the rows as the distance does; one matrix product computes it for all rows. The product runs
    in float32, twice as fast as float64. Rows that its rounding error could have hidden are compared in float64, so
    the winner equals that of a float64 brute force; of equally near conditions the older one wins. The conditions that
    were near lately are tried first, which spares most searches.
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
        self._near: NearConditions | None = None
        """Conditions to try first; None: a search has to find them."""
        self._searches_left = 0
        """Searches before others are kept to try first."""
        self._update_views()

    def __len__(self) -> int:
        return self._count

    def insert(self, position: int, condition: tuple[float, ...] | NDArray[np.float64]) -> None:
        """Insert a condition (d,) before the one at `position`.

        Raises ValueError for a wrong length or a number that is not finite.
        """
        row = validated_row(condition, self._dimensions)
        if self._count == len(self._exact):
            self._grow()
        for array in (self._exact, self._rough, self._half_squares, self._norms):
            array[position + 1 : self._count + 1] = array[position : self._count]
        square = float(row @ row)
        self._exact[position] = row
        with np.errstate(over="ignore"):  # beyond _FLOAT32_REACH these two are not used
            self._rough[position] = row
            self._half_squares[position] = 0.5 * square
        self._norms[position] = norm = math.sqrt(square)
        self._largest_norm = max(self._largest_norm, norm)
        self._count += 1
        self._update_views()

    def remove(self, position: int) -> None:
        """Remove the condition at `position`; later ones move up by one position."""
        norm = float(self._norms[position])
        for array in (self._exact, self._rough, self._half_squares, self._norms):
            array[position : self._count - 1] = array[position + 1 : self._count]
        self._count -= 1
        if norm >= self._largest_norm:  # a removed far condition must not widen the bound
            self._largest_norm = float(self._norms[: self._count].max(initial=_SMALLEST_NORM))
        self._update_views()

    def distances(self, situation: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the exact distance of each condition to `situation` (d,), shape (n,), oldest first: slow."""
        return exact_distances(self._exact[: self._count], situation)

    def nearest(self, situation: NDArray[np.float64]) -> NearestCondition | None:
        """Return position and distance of the condition nearest to `situation` (d,), and of the runner-up.

        Returns None without conditions; of equally near conditions the older one is nearer.
        """
        if points.happens("the nearest rules are forgotten"):
            self._near = None
        if self._near is not None:
            nearest = self._near.nearest(situation)
            if nearest is not None:
                return nearest
            self._searches_left = 0 if self._near.has_served else _SEARCHES
            self._near = None
        if self._count == 0:
            return None
        if self._count == 1:
            return NearestCondition(0, self._distance(0, situation), -1, math.inf)
        return self._search(situation)

    def _search(self, situation: NDArray[np.float64]) -> NearestCondition:
        """Return the nearest of all conditions, at least two, and the runner-up; keep those that are near."""
        square = float(situation.dot(situation))
        reach = math.sqrt(square) + self._largest_norm
        if not reach < _FLOAT32_REACH:  # true for NaN as well
            return self._nearest_exact(situation, np.arange(self._count))
        scores = self._scores
        self._rough_rows.dot(situation.astype(np.float32), scores)
        np.subtract(self._half_squares_rows, scores, scores)
        error = _ERROR_FACTOR * (self._dimensions + 4) * reach * (self._largest_norm + _FLOAT64_FACTOR * reach)
        if self._searches_left > 0:
            self._searches_left -= 1
        else:
            self._keep_near(situation, error, square, reach)
        best = int(scores.argmin())
        best_score = scores.item(best)
        scores[best] = math.inf
        second = int(scores.argmin())
        second_score = scores.item(second)
        scores[second] = math.inf
        third_score = scores.item(int(scores.argmin()))
        if second_score - best_score > error and third_score - second_score > error:
            return self._nearest_two(best, second, situation)
        scores[best], scores[second] = best_score, second_score
        return self._nearest_exact(situation, np.flatnonzero(scores <= second_score + error))

    def _keep_near(self, situation: NDArray[np.float64], error: float, square: float, reach: float) -> None:
        """Keep the conditions of the least scores, to try them first."""
        others_beyond = math.inf
        near = np.arange(min(self._count, _NEAR))
        if self._count > _NEAR:
            order = self._scores.argpartition(_NEAR)
            others_beyond = bound_of_others(self._scores.item(int(order[_NEAR])), error, square, reach)
            near = np.sort(order[:_NEAR])
        self._near = NearConditions(near, self._exact[near], situation, others_beyond)

    def _nearest_exact(self, situation: NDArray[np.float64], candidates: NDArray[np.intp]) -> NearestCondition:
        distances = exact_distances(self._exact[candidates], situation)
        first = int(distances.argmin())  # the first of equal ones is the oldest
        winner, distance = int(candidates[first]), float(distances[first])
        distances[first] = math.inf
        second = int(distances.argmin())
        return NearestCondition(winner, distance, int(candidates[second]), float(distances[second]))

    def _distance(self, position: int, situation: NDArray[np.float64]) -> float:
        """Return `exact_distances` of one row."""
        return math.sqrt(exact_square(self._exact[position] - situation))

    def _nearest_two(self, best: int, second: int, situation: NDArray[np.float64]) -> NearestCondition:
        """Return `exact_distances` of two rows, in half the time of two calls of `_distance`."""
        rows, squares = self._pair, self._squares
        np.subtract(self._exact[best], situation, rows[0])
        np.subtract(self._exact[second], situation, rows[1])
        np.multiply(rows, rows, rows)
        pairwise_sum(rows, 1, out=squares)
        return NearestCondition(best, math.sqrt(squares.item(0)), second, math.sqrt(squares.item(1)))

    def _grow(self) -> None:
        self._exact = _doubled(self._exact)
        self._rough = _doubled(self._rough)
        self._half_squares = _doubled(self._half_squares)
        self._norms = _doubled(self._norms)

    def _update_views(self) -> None:
        self._near = None
        self._rough_rows = self._rough[: self._count]
        self._half_squares_rows = self._half_squares[: self._count]
        self._scores = np.empty(self._count, dtype=np.float32)


def _doubled(array: NDArray[_Number]) -> NDArray[_Number]:
    """Return the rows with as many uninitialised ones appended; writing zeros would lengthen this tick."""
    longer = np.empty((2 * len(array), *array.shape[1:]), dtype=array.dtype)
    longer[: len(array)] = array
    return longer


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
