"""Search for the nearest condition, against a brute force."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from kurt2rt.core.rla.matching import ConditionIndex, exact_distances, exact_square
from tests.examples import examples

Point = tuple[float, ...]


def index_of(conditions: list[Point]) -> ConditionIndex:
    index = ConditionIndex(len(conditions[0]))
    for condition in conditions:
        index.insert(len(index), condition)
    return index


def assert_right(index: ConditionIndex, conditions: NDArray[np.float64], situation: NDArray[np.float64]) -> None:
    """Compare the index with a brute force over all living conditions."""
    nearest = index.nearest(situation)
    if len(conditions) == 0:
        assert nearest is None
        return
    assert nearest is not None
    distances = exact_distances(conditions, situation)
    assert nearest.position == int(distances.argmin())  # the first of equal ones is the older
    assert nearest.distance == float(distances.min())  # bit for bit
    if len(conditions) == 1:
        assert (nearest.runner_up, nearest.runner_up_distance) == (-1, math.inf)
        return
    distances[nearest.position] = math.inf
    others = np.delete(distances, nearest.position)
    assert nearest.runner_up_distance == float(others.min())  # bit for bit, too
    if math.isfinite(nearest.runner_up_distance):
        assert nearest.runner_up == int(distances.argmin())


_STEPS = st.integers(-3, 3).map(float)
_SCALES = (1.0, 1e-150, 1e-22, 1e-19, 1e-7, 1e7, 1e18, 1e19, 1e25, 1e40, 1e150)
KINDS_OF_VALUES: tuple[st.SearchStrategy[float], ...] = (
    st.integers(0, 1023).map(float),  # what the sensors give
    st.integers(0, 2).map(float),  # many duplicates
    _STEPS.map(lambda step: 500.0 + step * 1e-9),  # float32 sees one point only
    _STEPS.map(lambda step: 1e6 + step),  # far from the origin, close together
    _STEPS.map(lambda step: 1e9 + step * 1e-6),
    *(st.floats(-1.0, 1.0, width=16).map(scale.__mul__) for scale in _SCALES),
    st.sampled_from((0.0, 1e-22, 1.0, 1e9, 1e17, 1e20)),  # all sizes in one set
)
"""One kind is drawn for a whole set of conditions: each hides a rounding trouble of its own."""


@st.composite
def worlds(draw: st.DrawFn) -> tuple[list[tuple[Point, int] | int], list[Point]]:
    """Return random inserts (point, position), removals (position) and situations."""
    values = draw(st.sampled_from(KINDS_OF_VALUES))
    points: st.SearchStrategy[Point] = st.tuples(*[values] * draw(st.integers(1, 6)))
    at_the_end = st.tuples(points, st.just(-1))  # as lessons come; elsewhere, as deletions are undone
    somewhere = st.tuples(points, st.integers(0, 1000))
    steps = draw(st.lists(st.one_of(at_the_end, at_the_end, somewhere, st.integers(0, 1000)), max_size=40))
    return steps, draw(st.lists(points, min_size=1, max_size=3))


@given(worlds())
@examples(400)
@example(([((1.5e19,), -1), ((2.7e19,), -1)], [(1.3e19,)]))
@example(([((0.3,), -1), ((0.6,), -1)], [(1e16,)]))
@example(([((2.1e-22,), -1), ((1.2e-22,), -1)], [(1.7e-22,)]))
@example(([((3e20, 0.0), -1), ((1.0, 0.0), -1)], [(2.0, 0.0)]))
def test_condition_index_random_changes_equal_brute_force(
    world: tuple[list[tuple[Point, int] | int], list[Point]],
) -> None:
    steps, situations = world
    index = ConditionIndex(len(situations[0]))
    living: list[Point] = []
    for step in steps:
        if isinstance(step, tuple):
            point, place = step
            position = len(living) if place < 0 else place % (len(living) + 1)
            index.insert(position, point)
            living.insert(position, point)
        elif living:
            index.remove(step % len(living))
            del living[step % len(living)]
    assert len(index) == len(living)
    conditions = np.array(living).reshape(len(living), len(situations[0]))
    for point in [*situations, *living[:3]]:
        assert_right(index, conditions, np.array(point))


@given(st.integers(0, 2**32), st.sampled_from((3, 8, 9, 36, 72, 129, 200)), st.integers(1, 150))
@examples(100)
def test_condition_index_72_dimensions_equal_brute_force(seed: int, dimensions: int, size: int) -> None:
    """Half the values are whole counts, half are averages of up to 1000 counts, as Perception makes them."""
    chance = np.random.default_rng(seed)
    half = dimensions // 2
    rows = np.concatenate(
        (
            chance.integers(60, 560, (size, dimensions - half)).astype(float),
            chance.integers(60_000, 560_000, (size, half)) / 1000,
        ),
        axis=1,
    )
    rows[chance.integers(0, size, size // 3)] = rows[chance.integers(0, size, size // 3)]  # duplicates
    index = index_of([tuple(row) for row in rows.tolist()])
    between = 0.5 * (rows[0] + rows[-1])
    for situation in (rows[size // 2], rows[0] + 1e-10, between, chance.uniform(0, 600, dimensions)):
        assert_right(index, rows, situation)


@given(st.integers(0, 2**32), st.sampled_from((0.0, 1e-7, 1.0, 30.0, 1e9)), st.integers(2, 60))
@examples(100)
def test_condition_index_situations_in_a_row_equal_brute_force(seed: int, step: float, size: int) -> None:
    """The situations follow one another, as those of a robot; now and then the conditions change."""
    chance = np.random.default_rng(seed)
    rows = [tuple(row) for row in chance.integers(60, 560, (size, 10)).astype(float).tolist()]
    rows += rows[: size // 4]  # duplicates
    index, situation = index_of(rows), np.array(rows[0])
    for tick in range(40):
        situation = situation + chance.normal(0.0, step, 10)
        assert_right(index, np.array(rows), situation)
        if tick % 13 == 12:
            index.insert(0, rows[-1])
            rows.insert(0, rows[-1])
            index.remove(2)
            del rows[2]


def clustered(count: int, spread: float) -> NDArray[np.float64]:
    chance = np.random.default_rng(5)
    centres = chance.uniform(70, 550, (12, 72))
    rows: NDArray[np.float64] = centres[chance.integers(0, 12, count)] + chance.normal(0.0, spread, (count, 72))
    return rows


@pytest.mark.parametrize("spread", [30.0, 1e-10])
def test_condition_index_5000_clusters_equal_brute_force(spread: float) -> None:
    rows = clustered(5000, spread)
    index = index_of([tuple(row) for row in rows.tolist()])
    chance = np.random.default_rng(6)
    for position in chance.integers(0, 5000, 20):
        assert_right(index, rows, rows[position] + chance.normal(0.0, spread, 72))


@pytest.mark.parametrize(
    ("condition", "problem"), [((1.0,), r"\b1 .*\b2\b"), ((1.0, math.nan), "finite"), ((math.inf, 0.0), "finite")]
)
def test_condition_index_unfit_condition_is_refused(condition: Point, problem: str) -> None:
    index = index_of([(1.0, 2.0)])
    with pytest.raises(ValueError, match=problem):
        index.insert(len(index), condition)
    assert len(index) == 1
    assert_right(index, np.array([[1.0, 2.0]]), np.array([1.0, 2.5]))


@pytest.mark.parametrize("dimensions", [1, 72, 10_000])
def test_exact_distances_equal_single_ones(dimensions: int) -> None:
    conditions = np.random.default_rng(1).normal(0.0, 100.0, (300, dimensions))
    situation = conditions.mean(axis=0)
    alone = [math.sqrt(exact_square(row - situation)) for row in conditions]
    assert exact_distances(conditions, situation).tolist() == alone
    assert exact_distances(conditions[:0], situation).shape == (0,)
