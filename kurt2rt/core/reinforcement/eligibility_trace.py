"""Eligibility trace: shares of the RLAs that drove up to a rewarded tick, later ones larger."""

import math
from collections.abc import Mapping

import numpy as np

from hal.numerics import round_portable
from kurt2rt.core.reinforcement.decision_history import DecisionHistory

LEAST_SHARE = 0.001
"""Least share: smaller ones have no visible effect and would fill the journal."""


EligibilityTrace = Mapping[int, float]
"""RLA id -> share of a reward about one tick. The sum is at most 1, less after standstill or outside all radii."""


def make_trace(
    recent: DecisionHistory,
    tick: int,
    *,
    trace_ticks: float,
    since: Mapping[int, int],
) -> EligibilityTrace:
    """Return the trace at a tick, from the stored decisions up to it.

    Args:
        recent: stored decisions.
        tick: rewarded tick.
        trace_ticks: time constant in ticks.
        since: RLA id -> tick in which it got its action; earlier decisions had another action and do not count.
    """
    decay = round_portable(math.exp(-1.0 / trace_ticks))
    reach = math.ceil(round_portable(-math.log(LEAST_SHARE) * trace_ticks))
    ticks, rlas = recent.answering_up_to(tick)
    for rla_id in since.keys() & set(rlas.tolist()):
        rlas[(rlas == rla_id) & (ticks < since[rla_id])] = 0
    fading = np.full(reach + 1, decay)
    fading[0] = 1.0
    fading[-1] = 0.0
    np.multiply.accumulate(fading, out=fading)  # powers by multiplication: the same on every processor
    weights = (1.0 - decay) * fading[np.minimum(tick - ticks, reach)]
    sums = np.bincount(rlas, weights)
    return {int(rla_id): float(sums[rla_id]) for rla_id in np.flatnonzero(sums >= LEAST_SHARE) if rla_id != 0}
