"""RLA system whose RLAs are the labels of a support vector machine, in place of the nearest one alone."""

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import SVC

from kurt2rt.core.learner.rla_learner import RlaLearner
from kurt2rt.experiments.rivals.learners.support_vectors import PairVotes

_WIDTH_SHARE = 0.347
"""Width of the kernel as a fraction of R: the 312 counts of the tuned machine of wall following."""


class RlaSvm(RlaLearner):
    """SVM with C = 10 that is fitted to the RLAs; it learns and asks as `RlaLearner` does.

    So it shows what the machine's way to decide is worth, apart from its labels and questions. No RLA explains its
    actions.
    """

    _fitted_to = -1
    """Number of changes of the RLA system that the machine was fitted to."""
    _votes: PairVotes | None = None
    """Votes of the machine; None if all RLAs have one action."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action of the largest decision value in a situation (d,); None where the nearest RLA would ask."""
        nearest = super().decide(situation, taught=taught)
        if nearest is None:
            return None
        if self._fitted_to != self.system.changes:
            self._fit()
        if self._votes is None:
            return nearest
        return self._actions[int(self._votes.values(situation * self.setting.weights).argmax())]

    def restore(self, data: bytes) -> None:
        """Hold the RLAs of a snapshot. Raises ValueError for bytes that are none."""
        super().restore(data)
        self._fitted_to = -1

    def _fit(self) -> None:
        rlas = self.system.rlas
        self._fitted_to, self._votes = self.system.changes, None
        actions = [rla.action for rla in rlas]
        if len(set(actions)) > 1:
            gamma = 0.5 / (_WIDTH_SHARE * self.setting.radius) ** 2
            machine = SVC(C=10.0, gamma=gamma, decision_function_shape="ovr")
            machine.fit(np.array([rla.condition for rla in rlas]) * self.setting.weights, actions)
            self._actions = [str(name) for name in machine.classes_]
            self._votes = PairVotes(machine, gamma)
