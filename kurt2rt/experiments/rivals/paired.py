"""Paired comparison of two rivals: McNemar's exact test, and Holm's correction for many of them."""

from collections.abc import Sequence
from math import comb
from typing import NamedTuple

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
