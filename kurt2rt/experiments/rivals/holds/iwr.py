"""IWR: interventions weigh as much as all else that was driven."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Why
from kurt2rt.experiments.rivals.holds.cloning import Cloning
from kurt2rt.experiments.rivals.holds.hold_learner import actions_of, points_of
from kurt2rt.experiments.rivals.holds.network import Classifier, Points
from kurt2rt.teacher.scripted.teacher_in_charge import Charge


class Iwr(Cloning):
    """Intervention Weighted Regression (Mandlekar et al. 2020, arXiv 2012.06733).

    It imitates the interventions and its own actions that its teacher let pass, each half of every batch. Here the
    halves are weights in the loss, of the same expectation. What was overruled is in neither. The demonstration before
    its first drive belongs to what is not an intervention, as in the paper.
    """

    charge = Charge.BY_TEACHER
    takes_own_samples = True

    def fit(self) -> None:
        """Fit the network to the weighted samples."""
        samples = [each for each in self.samples if each.why is not Why.OVERRULED]
        begins = next((place for place, each in enumerate(samples) if each.why is Why.DROVE), len(samples))
        interventions = [place > begins and each.why is not Why.DROVE for place, each in enumerate(samples)]
        self.policy = Classifier(
            points_of(samples),
            actions_of(samples),
            len(self.setting.actions),
            self.setting.seed,
            weights=self.weights(np.array(interventions)),
        )

    @staticmethod
    def weights(interventions: NDArray[np.bool_]) -> Points:
        """Return the weight (n,) of each sample, so that interventions and the others each weigh n / 2 in sum.

        `interventions`: whether each sample (n,) is of an intervention. Samples of a single kind weigh 1.
        """
        count, those = len(interventions), int(interventions.sum())
        if those in (0, count):
            return np.ones(count)
        return np.where(interventions, count / (2.0 * those), count / (2.0 * (count - those)))
