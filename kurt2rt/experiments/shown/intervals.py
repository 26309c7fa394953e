"""How sure a rate is."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

_RESAMPLES = 10_000
_BOOTSTRAP_SEED = 1
_TAIL = 0.025
_BISECTIONS = 100


class Rate(NamedTuple):
    """A rate and its 95 % interval."""

    value: float
    low: float
    high: float


def rate_of(counts: Sequence[int], exposures: Sequence[float]) -> Rate:
    """Events per unit of exposure over several drives, such as collisions per 10 min: one count and exposure each.

    The interval is the wider at each end of two. Poisson's exact one holds however rare the events are. The other is
    bootstrapped over the drives, since collisions come in clusters: a robot that was taught badly has many.
    """
    total = sum(exposures)
    events = sum(counts)
    fewest, most = poisson_interval(events)
    if events and len(counts) == 1:  # it says nothing of how robots differ
        return Rate(events / total, 0.0, math.inf)
    chance = np.random.default_rng(_BOOTSTRAP_SEED)
    drawn = chance.integers(len(counts), size=(_RESAMPLES, len(counts)))
    rates = np.asarray(counts)[drawn].sum(axis=1) / np.asarray(exposures)[drawn].sum(axis=1)
    low, high = np.quantile(rates, (_TAIL, 1 - _TAIL))
    return Rate(events / total, min(float(low), fewest / total), max(float(high), most / total))


def poisson_interval(events: int) -> tuple[float, float]:
    """95 % interval of the number that is to be expected where so many events were counted (Garwood 1936)."""
    # So many or more are as rare at the lower end as so many or fewer at the upper one.
    low = _expected_where(events - 1, 1 - _TAIL) if events else 0.0
    return low, _expected_where(events, _TAIL)


def _expected_where(at_most: int, probability: float) -> float:
    """The expected number for which `at_most` events or fewer have this probability; more expected make it less."""
    low, high = 0.0, 2.0 * at_most + 20.0
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        if _probability_of(at_most, middle) > probability:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _probability_of(at_most: int, expected: float) -> float:
    """Poisson's, of `at_most` events or fewer."""
    log = math.log(expected)
    return math.fsum(math.exp(k * log - expected - math.lgamma(k + 1)) for k in range(at_most + 1))


class Difference(NamedTuple):
    """A mean of differences and its 95 % interval."""

    value: float
    low: float
    high: float


def difference_of(changes: Sequence[float]) -> Difference:
    """The mean change of the same robots from one thing to another, bootstrapped over the robots.

    Where all changes are alike, as where none is, the interval is a point; one robot says nothing of others.
    """
    value = math.fsum(changes) / len(changes)
    if len(changes) == 1:
        return Difference(value, -math.inf, math.inf)
    chance = np.random.default_rng(_BOOTSTRAP_SEED)
    drawn = chance.integers(len(changes), size=(_RESAMPLES, len(changes)))
    low, high = np.quantile(np.asarray(changes, dtype=np.float64)[drawn].mean(axis=1), (_TAIL, 1 - _TAIL))
    return Difference(value, min(float(low), value), max(float(high), value))


def fall_of(before: Sequence[float], after: Sequence[float]) -> Difference:
    """By which share the sum of something falls in the same robots, bootstrapped over the robots, pairs kept together.

    Where there was nothing before, nothing falls.
    """
    were, are = np.asarray(before, dtype=np.float64), np.asarray(after, dtype=np.float64)
    value = 1.0 - math.fsum(after) / math.fsum(before) if any(before) else 0.0
    if len(before) == 1:
        return Difference(value, -math.inf, 1.0)
    drawn = np.random.default_rng(_BOOTSTRAP_SEED).integers(len(were), size=(_RESAMPLES, len(were)))
    sums = were[drawn].sum(axis=1)
    falls = 1.0 - np.divide(are[drawn].sum(axis=1), sums, out=np.ones_like(sums), where=sums > 0)
    low, high = np.quantile(falls, (_TAIL, 1 - _TAIL))
    return Difference(value, min(float(low), value), max(float(high), value))
