"""Support vector machine with a margin gate, as in confidence-based autonomy (Chernova, Veloso 2009)."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from sklearn.svm import SVC

from kurt2rt.core.learner.label_learner import LabelLearner, Points


class PairVotes:
    """Decision values of a fitted machine, as scikit-learn computes them, in a tenth of its time for one point."""

    def __init__(self, machine: SVC, gamma: float) -> None:
        """Read the machine of each pair of classes; `gamma`: of its RBF kernel."""
        self._gamma, self._vectors, self._offsets = gamma, machine.support_vectors_, machine.intercept_
        ends = np.cumsum(machine.n_support_)
        own = [slice(end - count, end) for end, count in zip(ends, machine.n_support_, strict=True)]
        self._pairs = list(combinations(range(len(own)), 2))
        # dual_coef_ has the coefficients of class i against each other class, without a row for i itself.
        self._weights = np.zeros((len(self._pairs), len(self._vectors)))
        for row, (one, other) in enumerate(self._pairs):
            self._weights[row, own[one]] = machine.dual_coef_[other - 1, own[one]]
            self._weights[row, own[other]] = machine.dual_coef_[one, own[other]]
        self._sides = np.zeros((len(self._pairs), len(own)))
        for row, (one, other) in enumerate(self._pairs):
            self._sides[row, one], self._sides[row, other] = 1.0, -1.0

    def values(self, point: Points) -> Points:
        """Return the value (classes,) of each class at a point (d,): its votes, and its confidence as a fraction.

        For two classes it is half of the one value that scikit-learn gives, with either sign.
        """
        away = self._vectors - point
        kernel = np.exp(-self._gamma * np.einsum("ij,ij->i", away, away))
        decisions = self._weights @ kernel + self._offsets
        values: Points
        if len(self._pairs) == 1:
            values = np.array([-decisions[0], decisions[0]]) / 2.0  # scikit-learn turns the sign for two classes
            return values
        confidence = decisions @ self._sides
        # As sklearn.utils.multiclass._ovr_decision_function.
        votes = ((np.where(decisions > 0.0, 1.0, -1.0) @ self._sides) + self._sides.shape[1] - 1) / 2.0
        values = votes + confidence / (3.0 * (np.abs(confidence) + 1.0))
        return values


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
            self._machine = SVC(C=10.0, gamma=1.0 / (2.0 * width**2), decision_function_shape="ovr")
            self._machine.fit(points, list(actions))
            self._votes = PairVotes(self._machine, 1.0 / (2.0 * width**2))

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action of the largest decision value at a point (d,); None if it is far, or the lead small."""
        if not self.is_near(point, taught=taught):
            return None
        if self._machine is None:
            return self._only
        values = self._votes.values(point)
        runner_up, best = np.sort(values)[-2:]
        if best - runner_up < self.gate(0.3):
            return None
        return str(self._machine.classes_[int(values.argmax())])
