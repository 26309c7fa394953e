"""Benchmark of the search for the nearest condition."""

import time
from typing import NamedTuple

import numpy as np

from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import SEED, OnProgress
from kurt2rt.core.rla.matching import ConditionIndex, exact_distances
from kurt2rt.platform.ledger import percentiles_of

DIMENSIONS = 72
"""Dimensions of the basic situation (paper, VI.B.1)."""
LARGEST_COUNTS = 600.0
NOISE_COUNTS = 20.0
REFERENCE_STRIDE = 10
"""Calls per call of the slow brute force."""


class Size(NamedTuple):
    """Number of RLAs with its goal."""

    rlas: int
    limit_us: float
    calls: int


SIZES = (Size(135, 10.0, 5000), Size(1_000, 15.0, 5000), Size(100_000, 1500.0, 400))


class WrongWinnerError(RuntimeError):
    """Index and brute force with different winners, which makes the times meaningless."""


def measure_match(sizes: tuple[Size, ...], on_progress: OnProgress) -> tuple[BenchResult, ...]:
    """Measure the match for each number of RLAs, alternating with a float64 brute force.

    Raises WrongWinnerError if the two find different RLAs.
    """
    results = []
    for number, size in enumerate(sizes, start=1):
        results.append(_measure(size))
        on_progress(number / len(sizes))
    return tuple(results)


def _measure(size: Size) -> BenchResult:
    chance = np.random.default_rng(SEED)
    conditions = chance.uniform(0.0, LARGEST_COUNTS, (size.rlas, DIMENSIONS))
    index = ConditionIndex(DIMENSIONS)
    for row in conditions:
        index.append(tuple(row.tolist()))
    took_ns: list[int] = []
    reference_ns: list[int] = []
    for call in range(size.calls):
        # Near some condition, as the situations of a robot that knows its way are.
        situation = conditions[chance.integers(size.rlas)] + chance.normal(0.0, NOISE_COUNTS, DIMENSIONS)
        begun_ns = time.perf_counter_ns()
        nearest = index.nearest(situation)
        took_ns.append(time.perf_counter_ns() - begun_ns)
        if call % REFERENCE_STRIDE == 0:
            begun_ns = time.perf_counter_ns()
            winner = int(exact_distances(conditions, situation).argmin())
            reference_ns.append(time.perf_counter_ns() - begun_ns)
            if nearest is None or nearest.position != winner:
                raise WrongWinnerError(
                    f"{size.rlas} RLAs, call {call}: the index names {nearest}, float64 names {winner}; "
                    "run the tests of kurt2rt/core/rla"
                )
    took = percentiles_of(took_ns)
    return BenchResult(
        "match",
        f"nearest of {size.rlas} RLAs",
        took,
        Reference("brute force", percentiles_of(reference_ns).median_us, took.median_us),
        (BenchGoal("median us", took.median_us, size.limit_us),),
    )
