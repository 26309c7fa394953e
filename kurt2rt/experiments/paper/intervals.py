"""How sure a rate is."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

_RESAMPLES = 10_000
_BOOTSTRAP_SEED = 1


class Rate(NamedTuple):
    """A rate and its 95 % interval."""

    value: float
    low: float
    high: float


def rate_of(counts: Sequence[int], exposures: Sequence[float]) -> Rate:
    """Events per unit of exposure over several robots, such as collisions per 10 min: one count and exposure each.

    The interval is bootstrapped over robots, since collisions come in clusters: a robot that was taught badly has many.
    Where nothing ever happened there is nothing to draw from, and the upper end is Poisson's exact one.
    """
    total = sum(exposures)
    if not any(counts):
        return Rate(0.0, 0.0, -math.log(0.025) / total)
    if len(counts) == 1:  # it says nothing of how robots differ
        return Rate(sum(counts) / total, 0.0, math.inf)
    chance = np.random.default_rng(_BOOTSTRAP_SEED)
    drawn = chance.integers(len(counts), size=(_RESAMPLES, len(counts)))
    rates = np.asarray(counts)[drawn].sum(axis=1) / np.asarray(exposures)[drawn].sum(axis=1)
    low, high = np.quantile(rates, (0.025, 0.975))
    return Rate(sum(counts) / total, float(low), float(high))
