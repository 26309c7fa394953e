"""Learners of scikit-learn, refitted to all labels after each lesson: support vectors, and a decision tree."""

from collections.abc import Sequence

import numpy as np
from sklearn.svm import SVC
from sklearn.tree import DecisionTreeClassifier

from kurt2rt.core.learner.label_learner import LabelLearner, Points


class SupportVectors(LabelLearner):
    """SVM with C = 10, one against the rest by votes of pairs, and half of R as the kernel's width.

    It asks if no label lies within R, or if the best action leads the next one by less than the gate, in units of the
    decision function; 0.3 by default.
    """

    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Fit the machine to points (n, d) and their actions; a single action needs none."""
        self._machine = None
        self._only = actions[0]
        if len(set(actions)) > 1:
            width = self.setting.radius / 2.0
            self._machine = SVC(C=10.0, gamma=0.5 / (width * width), decision_function_shape="ovr")
            self._machine.fit(points, list(actions))

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action of the largest decision value at a point (d,); None if it is far, or the lead small."""
        if not self.is_near(point, taught=taught):
            return None
        if self._machine is None:
            return self._only
        found = self._machine.decision_function(point[None])[0]
        # For two classes scikit-learn gives one value, by which the second one leads.
        values = np.array([-found, found]) / 2.0 if np.ndim(found) == 0 else found
        runner_up, best = np.sort(values)[-2:]
        if best - runner_up < self.gate(0.3):
            return None
        return str(self._machine.classes_[int(values.argmax())])


class DecisionTree(LabelLearner):
    """Tree of scikit-learn's defaults; its leaves are pure, so it asks before its first lesson and never again."""

    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Fit the tree to points (n, d) and their actions."""
        self._tree = DecisionTreeClassifier(random_state=self.setting.seed).fit(points, list(actions))

    def choose(self, point: Points, *, taught: bool) -> str | None:  # noqa: ARG002 - it never asks
        """Return the action of the leaf of a point (d,)."""
        return str(self._tree.predict(point[None])[0])
