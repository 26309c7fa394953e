"""Situation from sensor readings, tick by tick, and the ring buffer of its averages."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from kurt2rt.core.perception.perception import History, Perception
from tests.core.perception.helpers import READINGS, SENSORS, definition, sensed


def test_perception_situation_is_never_changed() -> None:
    perception = Perception(definition(READINGS), SENSORS)
    first = perception.perceive(sensed(10, 20, 0, 0), history_frozen=False)
    perception.perceive(sensed(99, 99, 0, 0), history_frozen=False)
    assert first.vector.tolist() == [20, 10, 20, 10]


def average(history: History, width: int) -> NDArray[np.float64]:
    out = np.full(width, np.nan)
    history.average_into(out)
    return out


@pytest.mark.parametrize("steps", [1, 7, 1000])
def test_history_random_steps_are_exact(steps: int) -> None:
    chance = np.random.default_rng(steps)
    rows = chance.integers(-1000, 1024, (1500, 5))
    history = History(steps, 5)
    assert average(history, 5).tolist() == [0.0] * 5
    for taken, row in enumerate(rows, start=1):
        history.push(row)
        held = rows[max(0, taken - steps) : taken]
        assert history.filled == len(held)
        assert (average(history, 5) == held.sum(axis=0) / len(held)).all()


@given(st.integers(1, 5), st.lists(st.integers(-(10**15), 10**15), max_size=30))
def test_history_large_numbers_leave_no_residue(steps: int, values: list[int]) -> None:
    history = History(steps, 1)
    for value in [*values, *[7] * steps]:
        history.push(np.array([value]))
    assert average(history, 1).tolist() == [7.0]


def test_history_pushed_array_may_change_later() -> None:
    history, row = History(2, 1), np.array([5])
    history.push(row)
    row[0] = 100
    history.push(np.array([7]))
    assert average(history, 1).tolist() == [6.0]
    history.push(np.array([7]))
    assert average(history, 1).tolist() == [7.0]
