"""SafeDAgger and LazyDAgger: a second network predicts where the policy would differ from its teacher."""

import numpy as np

from kurt2rt.experiments.rivals.holds.cloning import Cloning
from kurt2rt.experiments.rivals.holds.hold_learner import actions_of, points_of
from kurt2rt.experiments.rivals.holds.network import Classifier, Points
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

_HELD_OUT_EVERY = 5
"""One label of so many is kept from the policy, so that the safety network sees what the policy did not learn."""
_UNSAFE = 0.5
"""Discrepancy beyond which a label counts as unsafe: the policy gives the teacher's action less than even odds."""
_READY_FRACTION = 0.1
"""LazyDAgger's threshold of return, as a fraction of that of the take-over."""


class SafeDagger(Cloning):
    """SafeDAgger (Zhang and Cho, AAAI 2017, algorithm 1).

    The safety policy is a classifier of situations: unsafe if the policy differs from the teacher by more than a
    threshold (equations 1 and 2). The teacher drives where it says unsafe, and only those situations are labelled.
    The policy is fitted to four fifths of the labels, the safety policy to all of them.
    """

    charge = Charge.BY_ROBOT

    def fit(self) -> None:
        """Fit the policy, then the safety network to where the policy differs from the labels."""
        labelled, seed, count = self.labelled, self.setting.seed, len(self.setting.actions)
        points, actions = points_of(labelled), actions_of(labelled)
        learned = np.arange(len(labelled)) % _HELD_OUT_EVERY < max(1, _HELD_OUT_EVERY - 1)
        self.policy = Classifier(points[learned], actions[learned], count, seed)
        unsafe = [self.discrepancy(each.point, each.action) > self.threshold for each in labelled]
        self.safety = Classifier(points, np.array(unsafe, dtype=np.int64), 2, seed + 1)

    @property
    def threshold(self) -> float:
        """Discrepancy beyond which a situation is unsafe, 0 to 1."""
        return self.gate(_UNSAFE)

    def asks(self, point: Points) -> bool:
        """Return whether the safety network calls a point (d,) unsafe."""
        return float(self.safety.probabilities(point)[1]) > 0.5

    def is_ready(self, point: Points, action: int) -> bool:  # noqa: ARG002 - its rule is the same in both directions
        """Return whether the safety network calls a point (d,) safe."""
        return not self.asks(point)


class LazyDagger(SafeDagger):
    """LazyDAgger (Hoque et al., CASE 2021, algorithm 1): SafeDAgger with hysteresis.

    The robot asks as in SafeDAgger. It gets control back only where its action is within a second, smaller threshold
    of the action that the teacher really does. Noise on the teacher's actions (section IV-C) is left out: a person's
    hand brings some.
    """

    def is_ready(self, point: Points, action: int) -> bool:
        """Return whether its policy agrees well with the held action at a point (d,)."""
        return self.discrepancy(point, action) < self.threshold * _READY_FRACTION
