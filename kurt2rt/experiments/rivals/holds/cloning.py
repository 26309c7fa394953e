"""Policies that imitate labels: one network (BC, DAgger, IWR), or an ensemble with a doubt."""

import numpy as np

from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner, actions_of, points_of
from kurt2rt.experiments.rivals.holds.network import Classifier, Points
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

MEMBERS = 5
"""Networks of an ensemble, as in ThriftyDAgger (Hoque et al. 2021)."""


class Cloning(HoldLearner):
    """One network, fitted to all labels of the teacher."""

    def fit(self) -> None:
        """Fit the network to all labels."""
        labelled = self.labelled
        self.policy = Classifier(
            points_of(labelled), actions_of(labelled), len(self.setting.actions), self.setting.seed
        )

    def act(self, point: Points) -> Points:
        """Return the probability (actions,) of each action at a point (d,)."""
        return self.policy.probabilities(point)

    def discrepancy(self, point: Points, action: int) -> float:
        """Return how far its policy is from a teacher's action at a point (d,), 0 to 1.

        It is the total variation distance of its probabilities from the teacher's single action. The papers take the
        squared distance of two steering commands, which this repertoire of named actions does not have.
        """
        return 1.0 - float(self.act(point)[action])


class BehaviouralCloning(Cloning):
    """BC (Pomerleau 1989; Bain and Sammut 1995): the teacher drives all the time, and its policy is imitated."""

    charge = Charge.ALWAYS


class Ensemble(Cloning):
    """Networks of other first weights, each fitted to its own draw of all labels with replacement."""

    def fit(self) -> None:
        """Fit all members."""
        labelled = self.labelled
        points, actions = points_of(labelled), actions_of(labelled)
        self.members = []
        for member in range(MEMBERS):
            rng = np.random.default_rng((self.setting.seed, member))
            drawn = rng.integers(0, len(labelled), len(labelled))
            self.members.append(
                Classifier(points[drawn], actions[drawn], len(self.setting.actions), self.setting.seed + member)
            )

    def votes(self, point: Points) -> Points:
        """Return the probabilities (members, actions) of all members at a point (d,)."""
        return np.array([member.probabilities(point) for member in self.members])

    def act(self, point: Points) -> Points:
        """Return the mean probability (actions,) of each action at a point (d,)."""
        mean: Points = self.votes(point).mean(axis=0)
        return mean

    def variances(self, point: Points) -> Points:
        """Return the variance (actions,) over the members of each action's probability at a point (d,)."""
        variances: Points = self.votes(point).var(axis=0)
        return variances
