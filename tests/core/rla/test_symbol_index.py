"""Search for the nearest row of symbols."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.matching import SymbolIndex
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created

Symbols = tuple[float, ...]

HISTORIES = st.integers(1, 13).flatmap(
    lambda length: st.lists(st.tuples(*[st.integers(0, 4).map(float)] * length), min_size=1, max_size=12)
)


def index_of(histories: list[Symbols]) -> SymbolIndex:
    index = SymbolIndex(len(histories[0]))
    for each in histories:
        index.insert(len(index), each)
    return index


@given(HISTORIES)
def test_symbol_index_equal_distance_oldest_wins(histories: list[Symbols]) -> None:
    *taught, here = [*histories, histories[0]]
    index = index_of(taught)
    nearest = index.nearest(np.array(here))
    assert nearest is not None
    assert (nearest.position, nearest.distance) == (0, 0.0)
    if len(taught) == 1:
        assert (nearest.runner_up, nearest.runner_up_distance) == (-1, math.inf)
    else:
        others = index.distances(np.array(here))[1:].tolist()
        assert nearest.runner_up_distance == min(others)
        assert nearest.runner_up == 1 + others.index(min(others))


@pytest.mark.parametrize(("condition", "told"), [((1.0,), r"\b1 .*\b2\b"), ((1.0, math.nan), "fin")])
def test_symbol_index_unfit_condition_is_refused(condition: Symbols, told: str) -> None:
    index = index_of([(1.0, 1.0)])
    with pytest.raises(ValueError, match=told):
        index.insert(len(index), condition)
    assert len(index) == 1


def test_candidate_index_symbols_with_weights_are_refused() -> None:
    system = RlaSystem(2, 5.0, others={MID: Space(2, 1.0, np.ones(2), "hamming")})
    with pytest.raises(ValueError, match=r"hamming .*weights"):
        system.apply(created(1, (1.0, 1.0), level=MID))
