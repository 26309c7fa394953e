"""Paired comparison of two rivals: McNemar's exact test, and Holm's correction for many of them."""

from collections.abc import Sequence
from math import comb, sqrt
from statistics import mean, stdev
from typing import NamedTuple

from scipy.stats import t as students_t

from kurt2rt.experiments.rivals.outcome import RivalOutcome


class Pairs(NamedTuple):
    """Robots that passed with one of two rivals only, at the end of their lessons."""

    only_first: int
    only_second: int


def pairs_of(first: Sequence[RivalOutcome], second: Sequence[RivalOutcome]) -> Pairs:
    """Return the robots of equal seeds that passed with one of two rivals only; not judged ones do not count."""
    ends = [(one.checkpoints[-1], other.checkpoints[-1]) for one, other in zip(first, second, strict=True)]
    judged = [(one.passed, other.passed) for one, other in ends if one.judged and other.judged]
    return Pairs(judged.count((True, False)), judged.count((False, True)))


class Comparison(NamedTuple):
    """Comparison of a rival with the first one, at the end of their lessons."""

    pairs: Pairs
    p_value: float
    """p of McNemar's exact test, a probability."""
    corrected: float
    """The same, corrected for the number of rivals that were compared (Holm)."""


def compare_all(first: Sequence[RivalOutcome], others: Sequence[Sequence[RivalOutcome]]) -> list[Comparison]:
    """Return the comparison of each of the others with the first rival, in order."""
    pairs = [pairs_of(first, other) for other in others]
    p_values = [mcnemar_p(each) for each in pairs]
    return list(map(Comparison, pairs, p_values, holm(p_values)))


class Saving(NamedTuple):
    """Presses that the second of two rivals needs fewer on the same robot: mean, and its 95 % interval."""

    mean: float
    low: float
    high: float


def saving_of(first: Sequence[RivalOutcome], second: Sequence[RivalOutcome]) -> Saving | None:
    """Return the presses that the second of two rivals saves on robots of equal seeds; None for a single robot.

    The interval is Student's, of the differences robot by robot.
    """
    fewer = [one.presses - other.presses for one, other in zip(first, second, strict=True)]
    if len(fewer) < 2:
        return None
    middle = mean(fewer)
    half = float(students_t.ppf(0.975, len(fewer) - 1)) * stdev(fewer) / sqrt(len(fewer))
    return Saving(middle, middle - half, middle + half)


def mcnemar_p(pairs: Pairs) -> float:
    """Return the two-sided exact p of McNemar's test, a probability: of 1 without a robot that tells them apart."""
    trials, fewer = sum(pairs), min(pairs)
    tail = sum(comb(trials, count) for count in range(fewer + 1)) / 2.0**trials
    return min(1.0, 2.0 * tail)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p values corrected for their number (Holm 1979), probabilities in the order given."""
    corrected, largest = [0.0] * len(p_values), 0.0
    for rank, place in enumerate(sorted(range(len(p_values)), key=p_values.__getitem__)):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[place]))
        corrected[place] = largest
    return corrected
