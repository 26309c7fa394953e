"""Who is meant by a signal: the RLAs that drove up to the tick it is about, the later ones more (eligibility trace)."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from kurt2rt.core.numerics import round_portable
from kurt2rt.core.reinforcement.decision_history import DecisionHistory

LEAST_SHARE = 0.001
"""Smaller shares change nothing that could be told, and would fill the journal."""


class EligibilityTrace(NamedTuple):
    """What led to a tick."""

    shares: Mapping[int, float]
    """RLA id -> its share of the signal; together at most 1, less where the robot stood or nobody may be blamed."""
    transitions: tuple[tuple[int, int], ...]
    """(RLA id, follow-up RLA id), newest first."""


def make_trace(
    recent: DecisionHistory,
    tick: int,
    *,
    trace_ticks: float,
    most_transitions: int,
    since: Mapping[int, int],
) -> EligibilityTrace:
    """The trace at a tick, from the decisions that are remembered of the ticks up to it, and of none after it.

    `trace_ticks`: time constant. `since`: RLA id -> tick in which it got the action it has; what it did before with
    another one is neither its merit nor its fault.
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
    shares = {int(rla_id): float(sums[rla_id]) for rla_id in np.flatnonzero(sums >= LEAST_SHARE) if rla_id != 0}
    return EligibilityTrace(shares, _last_transitions(ticks.tolist(), rlas.tolist(), most_transitions))


def _last_transitions(ticks: list[int], rlas: list[int], most: int) -> tuple[tuple[int, int], ...]:
    """Standing still, and ticks in which nobody may be blamed, end a chain of transitions."""
    found: list[tuple[int, int]] = []
    for place in range(len(rlas) - 1, 0, -1):
        if len(found) == most:
            break
        before, after = rlas[place - 1], rlas[place]
        if before and after and before != after and ticks[place] - ticks[place - 1] == 1:
            found.append((before, after))
    return tuple(found)
