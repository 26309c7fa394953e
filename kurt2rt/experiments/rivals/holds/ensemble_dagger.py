"""EnsembleDAgger: the robot asks where the members of an ensemble disagree."""

from kurt2rt.experiments.rivals.holds.cloning import Ensemble
from kurt2rt.experiments.rivals.holds.network import Points
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

_DOUBT = 0.1
"""Doubt beyond which it asks. Robot 3900 passed in A and B and failed in C of wall following with 0.1 as with 0.2."""
_DISCREPANCY = 0.5
"""Discrepancy within which it gets control back."""


class EnsembleDagger(Ensemble):
    """EnsembleDAgger (Menda, Driggs-Campbell and Kochenderfer, IROS 2019, algorithm 2).

    The novice drives if its doubt and its discrepancy from the expert are both small. The discrepancy is known only
    while the teacher names an action, so the doubt alone decides when it asks, and both decide when it goes on.
    """

    charge = Charge.BY_ROBOT

    def doubt(self, point: Points) -> float:
        """Return the variance of the members' probabilities at a point (d,), summed over the actions, dimensionless."""
        return float(self.variances(point).sum())

    def asks(self, point: Points) -> bool:
        """Return whether its doubt at a point (d,) is beyond the threshold."""
        return self.doubt(point) > self.gate(_DOUBT)

    def is_ready(self, point: Points, action: int) -> bool:
        """Return whether both rules hold at a point (d,) where the teacher holds an action."""
        return not self.asks(point) and self.discrepancy(point, action) <= _DISCREPANCY
