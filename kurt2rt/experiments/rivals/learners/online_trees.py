"""Trees that learn each label once, in a stream: Hoeffding tree and adaptive random forest."""

from abc import abstractmethod
from collections.abc import Sequence

from river.base import Classifier
from river.forest import ARFClassifier
from river.tree import HoeffdingTreeClassifier

from kurt2rt.core.learner.label_learner import LabelLearner, Points
from kurt2rt.core.learner.learner import LearnerSetting

_GRACE_LABELS = 5
"""Labels in a leaf between two tries to split it; river's 200 are more than a lesson has."""


class OnlineTrees(LabelLearner):
    """Learner of labels in a stream; only a restore learns them all from the beginning.

    It asks if no label lies within R, or if the best action has a smaller probability than the gate; 0.2 by default.
    """

    def __init__(self, setting: LearnerSetting) -> None:
        super().__init__(setting)
        self._model, self._learned = self.new_model(), 0

    @abstractmethod
    def new_model(self) -> Classifier:
        """Return a model that has learned nothing."""

    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Learn those of the labels that are new: points (n, d) and their actions."""
        for point, action in zip(points[self._learned :], actions[self._learned :], strict=True):
            self._model.learn_one(dict(enumerate(point.tolist())), action)
        self._learned = len(actions)

    def restore(self, data: bytes) -> None:
        """Learn the labels of a snapshot from the beginning. Raises ValueError for bytes that are none."""
        super().restore(data)
        self._model, self._learned = self.new_model(), 0

    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the most probable action at a point (d,); None if it is far, or not probable enough."""
        if not self.is_near(point, taught=taught):
            return None
        found = self._model.predict_proba_one(dict(enumerate(point.tolist())))
        shares = {str(action): share for action, share in found.items()}
        if not shares:
            return None
        best = max(sorted(shares), key=shares.__getitem__)
        return best if shares[best] / sum(shares.values()) >= self.gate(0.2) else None


class HoeffdingTree(OnlineTrees):
    """Hoeffding tree (VFDT) of river, which tries a split after 5 labels."""

    def new_model(self) -> Classifier:
        """Return an empty tree."""
        return HoeffdingTreeClassifier(grace_period=_GRACE_LABELS)


class AdaptiveForest(OnlineTrees):
    """Adaptive random forest (ARF) of 10 trees of river, which try a split after 5 labels."""

    def new_model(self) -> Classifier:
        """Return an empty forest."""
        return ARFClassifier(n_models=10, seed=self.setting.seed, grace_period=_GRACE_LABELS)
