"""Conditions near one situation: the situations of a robot follow one another, so few can be the nearest soon."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

pairwise_sum = np.add.reduce
"""Pairwise sum, in an order that numpy fixes (loops_utils) for all processors."""


class NearestCondition(NamedTuple):
    """Nearest condition and the runner-up."""

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
        reach: |s| and the largest |c|, to the round-off of which the bound is widened.
    """
    return math.sqrt(max(0.0, square + 2.0 * (score - error))) - 1e-9 * reach
