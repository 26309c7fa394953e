"""Locally weighted vote within R, as VINN weighs its neighbours (Pari et al. 2022)."""

from collections.abc import Sequence

import numpy as np

from kurt2rt.core.learner.label_learner import LabelLearner, Points

_K = 10
_SHARPNESS = 10.0
"""Distance of R / 10 more makes a vote lighter by a factor e."""


class WeightedVote(LabelLearner):
    """Vote of the 10 nearest labels, each weighing exp(-10 distance / R).

    It asks if the nearest label is farther than the gate times R; gate 1 by default.
    """

    def fit(self, points: Points, actions: Sequence[str]) -> None:  # noqa: ARG002 - distances take the points
        """Keep the actions of the points (n, d)."""
        self._known = sorted(set(actions))
        self._class_of = np.array([self._known.index(action) for action in actions])

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action with the heaviest votes of the labels near a point (d,); None if all are far."""
        distances = self.distances(point)
        far = distances.min() > self.gate(1.0) * self.stricter(taught=taught) * self.setting.radius
        return None if far else self.vote(distances)

    def vote(self, distances: Points) -> str:
        """Return the action with the heaviest votes of the labels at the distances (n,), in counts."""
        nearest = np.argsort(distances, kind="stable")[:_K]
        # Relative to the nearest, because far from all labels every weight would round to 0.
        weights = np.exp(-_SHARPNESS * (distances[nearest] - distances[nearest[0]]) / self.setting.radius)
        return self._known[int(np.bincount(self._class_of[nearest], weights).argmax())]
