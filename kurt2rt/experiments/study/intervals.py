"""Confidence intervals of rates and differences."""

import math
from collections.abc import Callable, Sequence
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.experiments.lockstep.drive_row import DriveRow

FloatArray = NDArray[np.float64]

_RESAMPLES = 10_000
_BOOTSTRAP_SEED = 1
_TAIL = 0.025
_TWO_SIDED_95 = NormalDist().inv_cdf(1.0 - _TAIL)
"""Standard deviations on each side of the mean that hold 95 % of a normal distribution."""
TEN_MIN_S = 600.0


class Rate(NamedTuple):
    """Estimate over the drives of a study, a rate or a mean difference, with its 95 % interval."""

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


def collisions_in_10_min(drives: Sequence[DriveRow]) -> Rate:
    """Return the collisions in 10 min of driving over all drives together, with the 95 % interval."""
    return rate_of([each.collisions for each in drives], [each.duration_s / TEN_MIN_S for each in drives])


def right_rate(drives: Sequence[DriveRow]) -> Rate | None:
    """Return the share of the junctions of all drives that were left as asked, with its interval; None without any."""
    asked = [each for each in drives if each.junctions]
    if not asked:
        return None
    # Of the wrong ones, so that the interval of robots that never err does not shrink to a point.
    errs = rate_of([each.junctions - each.right for each in asked], [each.junctions for each in asked])
    return Rate(1 - errs.value, max(0.0, 1 - errs.high), 1 - errs.low)


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return the 95 % interval of a share (Wilson's score interval), as (low, high), each 0 to 1.

    It holds for few trials and shares near 0 and 1, too.

    Computed here: scipy.stats has it, but takes 0.6 s to import.
    """
    share, per_trial = successes / trials, _TWO_SIDED_95**2 / trials
    centre = share + per_trial / 2
    half_width = _TWO_SIDED_95 * math.sqrt(share * (1.0 - share) / trials + per_trial / (4 * trials))
    low, high = (centre - half_width) / (1.0 + per_trial), (centre + half_width) / (1.0 + per_trial)
    return low if successes else 0.0, high if successes < trials else 1.0


def quartiles(values: Sequence[float]) -> tuple[float, float, float]:
    """Return lower quartile, median and upper quartile by linear interpolation, in the unit of the values."""
    ordered = sorted(values)

    def at(share: float) -> float:
        place = share * (len(ordered) - 1)
        low = math.floor(place)
        high = min(low + 1, len(ordered) - 1)
        return ordered[low] + (place - low) * (ordered[high] - ordered[low])

    return at(0.25), at(0.5), at(0.75)


def difference_of(changes: Sequence[float], comparisons: int = 1) -> Rate:
    """Return the mean change of the same robots, with an interval bootstrapped over the robots.

    The interval of equal changes is a point, and infinite for one robot. The intervals of so many `comparisons` hold
    together with 95 % (Bonferroni).
    """
    value = math.fsum(changes) / len(changes)
    if len(changes) == 1:
        return Rate(value, -math.inf, math.inf)
    low, high = _bootstrapped(np.mean, changes, tail=_TAIL / comparisons)
    return Rate(value, min(low, value), max(high, value))


def fall_of(before: Sequence[float], after: Sequence[float]) -> Rate:
    """Return the relative fall of a sum in the same robots, bootstrapped over the pairs; 0 for a sum of 0 before."""
    value = 1.0 - math.fsum(after) / math.fsum(before) if any(before) else 0.0
    if len(before) == 1:
        return Rate(value, -math.inf, 1.0)

    def fall(were: FloatArray, are: FloatArray, axis: int) -> Any:
        sums = were.sum(axis)
        return 1.0 - np.divide(are.sum(axis), sums, out=np.ones_like(sums), where=sums > 0)

    low, high = _bootstrapped(fall, before, after)
    return Rate(value, min(low, value), max(high, value))
