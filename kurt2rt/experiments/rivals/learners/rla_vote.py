"""RLA system whose RLAs within R vote, in place of the nearest one alone."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.rla_learner import RlaLearner

_VOTERS = 10
_SHARPNESS = 10.0
"""Distance of R / 10 more makes a vote lighter by a factor e, as of the locally weighted vote."""


class RlaVote(RlaLearner):
    """Vote of the 10 nearest RLAs within R, each weighing exp(-10 distance / R).

    It learns and asks as `RlaLearner` does.
    """

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action of the heaviest votes for a situation (d,); None where the nearest RLA would ask."""
        if super().decide(situation, taught=taught) is None:
            return None
        system, radius = self.system, self.setting.radius
        votes: dict[str, float] = {}
        nearest = system.nearest_first(situation, limit=_VOTERS)
        for rla_id, distance in nearest:
            rla = system.get(rla_id)
            if rla is not None and distance <= radius:
                weight = float(np.exp(-_SHARPNESS * (distance - nearest[0][1]) / radius))
                votes[rla.action] = votes.get(rla.action, 0.0) + weight
        return max(votes, key=votes.__getitem__)
