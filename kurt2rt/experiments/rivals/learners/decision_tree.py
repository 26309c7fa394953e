"""Decision tree, refitted to all labels after each lesson."""

from collections.abc import Sequence

from sklearn.tree import DecisionTreeClassifier

from kurt2rt.core.learner.label_learner import LabelLearner, Points
from kurt2rt.experiments.rivals.learners.flat_trees import FlatTrees


class DecisionTree(LabelLearner):
    """Tree of scikit-learn's defaults; its leaves are pure, so it asks before its first lesson and never again."""

    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Fit the tree to points (n, d) and their actions."""
        tree = DecisionTreeClassifier(random_state=self.setting.seed).fit(points, list(actions))
        self._known = [str(name) for name in tree.classes_]
        self._tree = FlatTrees([tree])

    def choose(self, point: Points, *, taught: bool) -> str | None:  # noqa: ARG002 - it never asks
        """Return the action of the leaf of a point (d,)."""
        return self._known[int(self._tree.shares(point).argmax())]
