"""Gaussian process on the labels, with a gate on its variance."""

import math
from collections.abc import Sequence

import numpy as np

from kurt2rt.core.learner.label_learner import LabelLearner, Points

_NOISE = 0.05
"""Variance of a label, as a fraction of the prior's: teachers err in one of twenty answers."""
_GATE = 1.0 - math.exp(-1.0)
"""Variance at the distance R of a single label without noise."""


class GaussianProcess(LabelLearner):
    """GP regression on one-hot labels (least-squares classification), RBF kernel with R as length scale.

    It asks if the variance of its prediction exceeds the gate, a fraction of the prior's; 0.63 by default.
    """

    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Solve for the means of all actions at once, and for the variance, from points (n, d) and their actions."""
        self._known = sorted(set(actions))
        one_hot = np.array([[action == known for known in self._known] for action in actions], dtype=np.float64)
        # |a - b|² by products: all differences of 400 labels would be 100 MB.
        lengths = np.square(points).sum(axis=1)
        squares = np.maximum(lengths[:, None] + lengths[None, :] - 2.0 * points @ points.T, 0.0)
        covariance = self._kernel(squares)
        self._inverse = np.linalg.inv(covariance + _NOISE * np.eye(len(points)))
        self._means = self._inverse @ one_hot

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action with the largest mean at a point (d,); None if its variance is above the gate."""
        near = self._kernel(np.square(self.distances(point)))
        variance = 1.0 - float(near @ self._inverse @ near)
        if variance > self.gate(_GATE) * self.stricter(taught=taught):
            return None
        return self._known[int((near @ self._means).argmax())]

    def _kernel(self, squares: Points) -> Points:
        """Return the covariances of points at the squared distances `squares`, of any shape."""
        kernel: Points = np.exp(squares / (-2.0 * self.setting.radius**2))
        return kernel
