"""Learners that decide by the labels nearest to a situation: 1-NN, k-NN, and a weighted vote."""

from collections.abc import Sequence

import numpy as np

from kurt2rt.core.learner.label_learner import LabelLearner, Points

_K = 5
_VOTERS = 10
_SHARPNESS = 10.0
"""Distance of R / 10 more makes a vote lighter by a factor e."""


class _Comparing(LabelLearner):
    """Base of learners that compare a point with all labels."""

    def fit(self, points: Points, actions: Sequence[str]) -> None:  # noqa: ARG002 - distances take the points
        """Keep the actions of the points (n, d)."""
        self._said = list(actions)


class NearestNeighbour(_Comparing):
    """1-NN without R: it asks before its first lesson and never again, so all else is taught by corrections."""

    def choose(self, point: Points, *, taught: bool) -> str | None:  # noqa: ARG002 - it never asks
        """Return the action of the label nearest to a point (d,); of equally near ones the newest."""
        newest_first = self.distances(point)[::-1]
        return self._said[::-1][int(newest_first.argmin())]


class KNearest(_Comparing):
    """k-NN with k = 5: the action with most votes, of equal ones that of the nearest.

    It asks if the nearest label is farther than the gate times R; gate 1 by default.
    """

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action of most of the labels nearest to a point (d,); None if all are far."""
        distances = self.distances(point)
        nearest = np.argsort(distances, kind="stable")[:_K]
        if distances[nearest[0]] > self.gate(1.0) * self.stricter(taught=taught) * self.setting.radius:
            return None
        said: list[str] = [self._said[int(place)] for place in nearest]
        return max(said, key=said.count)


class WeightedVote(LabelLearner):
    """Vote of the 10 nearest labels, each weighing exp(-10 distance / R), as VINN does (Pari et al. 2022).

    It asks if the nearest label is farther than the gate times R; gate 1 by default.
    """

    def fit(self, points: Points, actions: Sequence[str]) -> None:  # noqa: ARG002 - distances take the points
        """Keep the actions of the points (n, d)."""
        self._known = sorted(set(actions))
        self._class_of = np.array([self._known.index(action) for action in actions])

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action with the heaviest votes of the labels near a point (d,); None if all are far."""
        distances = self.distances(point)
        if distances.min() > self.gate(1.0) * self.stricter(taught=taught) * self.setting.radius:
            return None
        nearest = np.argsort(distances, kind="stable")[:_VOTERS]
        # Relative to the nearest, because far from all labels every weight would round to 0.
        weights = np.exp(-_SHARPNESS * (distances[nearest] - distances[nearest[0]]) / self.setting.radius)
        return self._known[int(np.bincount(self._class_of[nearest], weights).argmax())]
