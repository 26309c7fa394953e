"""Decision tree, refitted to all labels after each lesson."""

from collections.abc import Sequence

from sklearn.tree import DecisionTreeClassifier

from kurt2rt.core.learner.label_learner import LabelLearner, Points


class DecisionTree(LabelLearner):
    """Tree of scikit-learn's defaults; its leaves are pure, so it asks before its first lesson and never again."""

    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Fit the tree to points (n, d) and their actions."""
        self._tree = DecisionTreeClassifier(random_state=self.setting.seed).fit(points, list(actions))

    def choose(self, point: Points, *, taught: bool) -> str | None:  # noqa: ARG002 - it never asks
        """Return the action of the leaf of a point (d,)."""
        return str(self._tree.predict(point[None])[0])
