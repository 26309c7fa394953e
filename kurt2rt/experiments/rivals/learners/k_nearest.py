"""Vote of the k nearest labels, within R."""

from collections.abc import Sequence

import numpy as np

from kurt2rt.core.learner.label_learner import LabelLearner, Points

_K = 5


class KNearest(LabelLearner):
    """k-NN with k = 5: the action with most votes, of equal ones that of the nearest.

    It asks if the nearest label is farther than the gate times R; gate 1 by default.
    """

    def fit(self, points: Points, actions: Sequence[str]) -> None:  # noqa: ARG002 - distances take the points
        """Keep the actions of the points (n, d)."""
        self._said: list[str] = list(actions)

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action of most of the labels nearest to a point (d,); None if all are far."""
        distances = self.distances(point)
        nearest = np.argsort(distances, kind="stable")[:_K]
        if distances[nearest[0]] > self.gate(1.0) * self.stricter(taught=taught) * self.setting.radius:
            return None
        said: list[str] = [self._said[int(place)] for place in nearest]
        return max(said, key=said.count)
