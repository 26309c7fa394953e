"""The batch's search for the nearest RLA equals the match of the runtime to the last bit."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.matching import exact_distances
from simbridge.batch.laws import Conditions, Floats
from simbridge.batch.matching import nearest_rla, scan_nearest
from simbridge.batch.record import Robots, Sizes, empty_robots
from simbridge.batch.tables import build_conditions

FEATURES, AVERAGE_STEPS = 36, 1000
HALVES, TENTHS = (0.0, 0.5, 1.0, 1.5, 2.0), (0.0, 0.1, 0.7, 1.3)


def one_robot() -> Robots:
    return empty_robots(1, Sizes(18, 6, 5))


def conditions_of(values: Floats, weights: Floats) -> Conditions:
    packed = np.zeros((len(values), 40))
    packed[:, :FEATURES] = values
    return build_conditions(packed, np.array([0, len(values)]), weights.tolist())


def matched(values: Floats, situation: Floats) -> tuple[int, float]:
    """Return row and distance as the runtime finds them, with 36 averages of weight 0."""
    padded = np.zeros((len(values), 2 * FEATURES))
    padded[:, :FEATURES] = values
    distances = exact_distances(padded, np.concatenate((situation, np.zeros(FEATURES))))
    return int(distances.argmin()), float(distances.min())


@given(
    rows=st.integers(1, 200),
    seed=st.integers(0, 2**32 - 1),
    most_step=st.sampled_from([3, 40, 1024]),
    few=st.booleans(),
    scale=st.sampled_from([HALVES, TENTHS]),
)
def test_nearest_of_a_moving_situation_is_that_of_the_match(
    rows: int, seed: int, most_step: int, few: bool, scale: tuple[float, ...]
) -> None:
    chance = np.random.default_rng(seed)
    weights = chance.choice(scale, FEATURES)
    # Few different conditions: many are equally near.
    kinds = chance.integers(0, 1024, (3 if few else rows, FEATURES))
    values = kinds[chance.integers(0, len(kinds), rows)] * weights
    conditions, robots = conditions_of(values, weights), one_robot()
    counts = chance.integers(0, 1024, FEATURES)
    for _ in range(12):
        counts = np.clip(counts + chance.integers(-most_step, most_step + 1, FEATURES), 0, 1023)
        robots["situation"][0, :FEATURES] = counts * weights
        expected = matched(values, counts * weights)
        assert nearest_rla(robots[0], 0, rows, conditions) == expected
        guess = int(chance.integers(-1, rows))
        assert scan_nearest(rows, guess, conditions.values, robots["situation"][0]) == expected


@pytest.mark.parametrize(
    ("scale", "weight", "is_whole"), [(1.0, 1.5, True), (0.5, 0.25, True), (0.3, 1.0, False), (1.0, 0.3, False)]
)
def test_conditions_are_whole_if_no_sum_is_rounded(scale: float, weight: float, is_whole: bool) -> None:
    values: Floats = np.arange(5.0 * FEATURES).reshape(5, FEATURES) * scale
    assert conditions_of(values, np.full(FEATURES, weight)).is_whole is is_whole


@given(rows=st.integers(1, 200), seed=st.integers(0, 2**32 - 1), most_step=st.sampled_from([3, 1024]))
def test_nearest_with_averages_is_that_of_the_match(rows: int, seed: int, most_step: int) -> None:
    chance = np.random.default_rng(seed)
    counts, sums = chance.integers(0, 1024, (rows, FEATURES)), chance.integers(0, 1_024_000, (rows, FEATURES))
    values: Floats = np.concatenate((counts, sums / AVERAGE_STEPS), axis=1)
    steps = [1.0] * FEATURES + [1.0 / AVERAGE_STEPS] * FEATURES
    conditions, robots = build_conditions(values, np.array([0, rows]), steps), one_robot()
    present, past = chance.integers(0, 1024, FEATURES), chance.integers(0, 1_024_000, FEATURES)
    for _ in range(8):
        present = np.clip(present + chance.integers(-most_step, most_step + 1, FEATURES), 0, 1023)
        past += chance.integers(-most_step, most_step + 1, FEATURES)
        situation = np.concatenate((present, past / AVERAGE_STEPS))
        robots["situation"][0, : 2 * FEATURES] = situation
        distances = exact_distances(values, situation)
        assert nearest_rla(robots[0], 0, rows, conditions) == (int(distances.argmin()), float(distances.min()))


@given(seed=st.integers(0, 2**32 - 1))
def test_nearest_is_of_the_table_of_the_wanted_behaviour(seed: int) -> None:
    chance, weights, robots = np.random.default_rng(seed), np.ones(FEATURES), one_robot()
    first = np.array([0, 20, 20, 50])
    values = chance.integers(0, 1024, (50, FEATURES)).astype(np.float64)
    packed = np.zeros((50, 40))
    packed[:, :FEATURES] = values
    conditions = build_conditions(packed, first, weights.tolist())
    counts = chance.integers(0, 1024, FEATURES)
    for table in chance.integers(0, 3, 30).tolist():
        counts = np.clip(counts + chance.integers(-9, 10, FEATURES), 0, 1023)
        robots["situation"][0, :FEATURES] = counts
        begin, end = int(first[table]), int(first[table + 1])
        found = nearest_rla(robots[0], begin, end, conditions)
        if begin == end:
            assert found == (-1, math.inf)
            continue
        row, distance = matched(values[begin:end], counts.astype(np.float64))
        assert found == (begin + row, distance)
