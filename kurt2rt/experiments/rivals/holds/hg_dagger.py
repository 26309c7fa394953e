"""HG-DAgger: the teacher takes over where it wants to, and only then it labels."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.experiments.rivals.holds.cloning import Ensemble
from kurt2rt.experiments.rivals.holds.network import Points
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

_LAST_SHARE = 0.25
"""Share of the last interventions that the threshold is the mean of."""


class HgDagger(Ensemble):
    """HG-DAgger (Kelly et al., ICRA 2019): labels of the interventions are aggregated; a doubt is learned besides.

    Doubt and threshold are a measure of risk for later drives (section III-C), and decide nothing in the lesson.
    """

    charge = Charge.BY_TEACHER

    def forget(self) -> None:
        """Forget the doubts of the interventions."""
        self._doubts: list[float] = []

    def on_takeover(self, situation: NDArray[np.float64]) -> None:
        """Note the doubt in a situation (d,) at the begin of an intervention."""
        if self.iteration:
            self._doubts.append(self.doubt(self.point(situation)))

    def doubt(self, point: Points) -> float:
        """Return the norm of the covariance's diagonal at a point (d,), dimensionless (equation 5)."""
        return float(np.linalg.norm(self.variances(point)))

    @property
    def doubt_threshold(self) -> float:
        """Mean doubt at the begin of the last quarter of all interventions, dimensionless (equation 6)."""
        doubts = self._doubts
        return float(np.mean(doubts[-max(1, round(_LAST_SHARE * len(doubts))) :]))
