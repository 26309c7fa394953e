"""Confidence intervals of rates and differences."""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_RESAMPLES = 10_000
_BOOTSTRAP_SEED = 1
_TAIL = 0.025


class Rate(NamedTuple):
    """A rate and its 95 % interval."""

    value: float
    low: float
    high: float


def rate_of(counts: Sequence[int], exposures: Sequence[float]) -> Rate:
    """Return the events per unit of exposure over several drives, such as collisions in 10 min.

    `counts` and `exposures`: one value per drive. The interval is the wider at each end of two: Poisson's exact one for
    rare events, and a bootstrap over the drives, because collisions come in clusters.
    """
    total = sum(exposures)
    events = sum(counts)
    fewest, most = poisson_interval(events)
    if len(counts) == 1:  # a single drive says nothing of how robots differ
        return Rate(events / total, 0.0, math.inf if events else most / total)
    low, high = _bootstrapped(lambda seen, of, axis: seen.sum(axis) / of.sum(axis), counts, exposures)
    return Rate(events / total, min(low, fewest / total), max(high, most / total))


def poisson_interval(events: int) -> tuple[float, float]:
    """Return the exact 95 % interval (low, high) of the expected count, given a count (Garwood 1936)."""
    from scipy.special import gammainccinv, gammaincinv  # scipy.stats has it as chi2, but takes 0.7 s more to import

    low = gammaincinv(events, _TAIL) if events else 0.0
    return float(low), float(gammainccinv(events + 1, _TAIL))


def _bootstrapped(statistic: Callable[..., Any], *samples: Sequence[float], tail: float = _TAIL) -> tuple[float, float]:
    """Return the percentile interval of `statistic(*samples, axis)` over robots, each with all its values.

    `tail`: fraction outside of the interval at each end; of 95 % by default.
    """
    values = [np.asarray(sample, dtype=np.float64) for sample in samples]
    robots = len(values[0])
    drawn = np.random.default_rng(_BOOTSTRAP_SEED).integers(0, robots, (_RESAMPLES, robots))
    statistics = statistic(*(sample[drawn] for sample in values), axis=-1)
    low, high = np.quantile(statistics, (tail, 1.0 - tail))
    return float(low), float(high)


class RateDifference(NamedTuple):
    """A mean of differences and its 95 % interval."""

    value: float
    low: float
    high: float


def difference_of(changes: Sequence[float], comparisons: int = 1) -> RateDifference:
    """Return the mean change of the same robots, with an interval bootstrapped over the robots.

    The interval of equal changes is a point, and infinite for one robot.

    Args:
        changes: one for each robot.
        comparisons: number of comparisons whose intervals hold together with 95 % (Bonferroni); each one is wider.
    """
    value = math.fsum(changes) / len(changes)
    if len(changes) == 1:
        return RateDifference(value, -math.inf, math.inf)
    low, high = _bootstrapped(np.mean, changes, tail=_TAIL / comparisons)
    return RateDifference(value, min(low, value), max(high, value))


def fall_of(before: Sequence[float], after: Sequence[float]) -> RateDifference:
    """Return the relative fall of a sum in the same robots, bootstrapped over the pairs; 0 for a sum of 0 before."""
    value = 1.0 - math.fsum(after) / math.fsum(before) if any(before) else 0.0
    if len(before) == 1:
        return RateDifference(value, -math.inf, 1.0)

    def fall(were: FloatArray, are: FloatArray, axis: int) -> Any:
        sums = were.sum(axis)
        return 1.0 - np.divide(are.sum(axis), sums, out=np.ones_like(sums), where=sums > 0)

    low, high = _bootstrapped(fall, before, after)
    return RateDifference(value, min(low, value), max(high, value))
