"""Decision trees of scikit-learn as arrays: a prediction takes microseconds in place of milliseconds."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sklearn.tree import DecisionTreeClassifier


class FlatTrees:
    """Fitted trees with the same classes, walked side by side."""

    def __init__(self, trees: Sequence[DecisionTreeClassifier]) -> None:
        most = max(tree.tree_.node_count for tree in trees)
        shape = (len(trees), most)
        self._features = np.zeros(shape, dtype=np.int64)
        self._thresholds = np.zeros(shape)
        self._left = np.zeros(shape, dtype=np.int64)
        self._right = np.zeros(shape, dtype=np.int64)
        self._shares = np.zeros((*shape, len(trees[0].classes_)))
        for row, tree in enumerate(trees):
            nodes, inner = tree.tree_, tree.tree_.node_count
            leaf = nodes.children_left < 0
            here = np.arange(inner)
            # A leaf leads to itself, so that all trees take as many steps as the deepest.
            self._features[row, :inner] = np.where(leaf, 0, nodes.feature)
            self._thresholds[row, :inner] = nodes.threshold
            self._left[row, :inner] = np.where(leaf, here, nodes.children_left)
            self._right[row, :inner] = np.where(leaf, here, nodes.children_right)
            values = nodes.value[:, 0, :]
            self._shares[row, :inner] = values / values.sum(axis=1, keepdims=True)
        self._depth = max(tree.get_depth() for tree in trees)
        self._rows = np.arange(len(trees))

    def shares(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mean share of each class in the leaves of a point (d,), shape (classes,), as predict_proba."""
        rows, nodes = self._rows, np.zeros(len(self._rows), dtype=np.int64)
        narrow = point.astype(np.float32)  # as scikit-learn compares
        for _ in range(self._depth):
            goes_left = narrow[self._features[rows, nodes]] <= self._thresholds[rows, nodes]
            nodes = np.where(goes_left, self._left[rows, nodes], self._right[rows, nodes])
        shares: NDArray[np.float64] = self._shares[rows, nodes].mean(axis=0)
        return shares
