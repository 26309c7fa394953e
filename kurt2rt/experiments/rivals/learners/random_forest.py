"""Random forest with a gate on its votes."""

from collections.abc import Sequence

from sklearn.ensemble import RandomForestClassifier

from kurt2rt.core.learner.label_learner import LabelLearner, Points
from kurt2rt.experiments.rivals.learners.flat_trees import FlatTrees

_TREES = 50


class RandomForest(LabelLearner):
    """Forest of 50 trees, else scikit-learn's defaults, refitted to all labels after each lesson.

    It asks if no label lies within R, or if the best action has a smaller share of the votes than the gate; 0.2 by
    default, because it asks where it was just taught with 0.4 (seeds 4100 to 4102), and with 0.2 not (3905 and 3906).
    """

    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Fit the forest to points (n, d) and their actions."""
        forest = RandomForestClassifier(_TREES, random_state=self.setting.seed, n_jobs=1).fit(points, list(actions))
        self._known = [str(name) for name in forest.classes_]
        self._trees = FlatTrees(forest.estimators_)

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action with most votes at a point (d,); None if it is far, or the votes are too few."""
        if not self.is_near(point, taught=taught):
            return None
        shares = self._trees.shares(point)
        best = int(shares.argmax())
        return self._known[best] if shares[best] >= self.gate(0.2) else None
