"""Search for the nearest row of symbols."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.event_error import EventFault
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.matching import SymbolIndex
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, deleted, refused_by, replaced, undone

Symbols = tuple[float, ...]

HISTORIES = st.integers(1, 13).flatmap(
    lambda length: st.lists(
        st.tuples(*[st.integers(0, 4).map(float)] * length),
        min_size=1,
        max_size=12,
    )
)


def index_of(histories: list[Symbols]) -> SymbolIndex:
    index = SymbolIndex(len(histories[0]))
    for each in histories:
        index.append(each)
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
        index.append(condition)
    assert len(index) == 1


def system_of(*events: TeachingEvent) -> RlaSystem:
    system = RlaSystem(2, 5.0, others={MID: Space(4, 1.0, None, "hamming")})
    system.apply_all(events)
    return system


def matched(system: RlaSystem, *here: float) -> tuple[int, float, bool]:
    at: NDArray[np.float64] = np.array(here)
    match = system.match(at, level=MID)
    assert match is not None
    return match.rla.rla_id, match.distance, match.known


def test_rla_system_symbol_level_takes_all_events() -> None:
    system = system_of(
        created(1, (1.0, 2.0, 3.0, 0.0), "turn_left", level=MID),
        created(2, (3.0, 2.0, 1.0, 0.0), "straight_on", level=MID),
    )
    assert matched(system, 1.0, 2.0, 2.0, 0.0) == (1, 1.0, True)
    assert matched(system, 3.0, 1.0, 2.0, 0.0) == (2, 2.0, False)
    system.apply(replaced(1, "turn_right", "turn_left"))
    system.apply(deleted(2))
    assert matched(system, 3.0, 2.0, 1.0, 0.0) == (1, 2.0, False)
    system.apply(undone("deletion-2"))
    assert matched(system, 3.0, 2.0, 1.0, 0.0) == (2, 0.0, True)
    assert system.rlas == ()
    assert [rla.rla_id for rla in system.rlas_at(MID)] == [1, 2]


def test_rla_system_changes_count_applied_events() -> None:
    system = system_of(created(1, (0.0,) * 4, level=MID))
    before = system.changes
    system.apply(replaced(1, "turn_left", "forward"))
    assert system.changes == before + 1
    assert refused_by(system, deleted(7)).fault is EventFault.NO_RLA
    assert system.changes == before + 1


def test_candidate_index_symbols_with_weights_are_refused() -> None:
    system = RlaSystem(2, 5.0, others={MID: Space(2, 1.0, np.ones(2), "hamming")})
    with pytest.raises(ValueError, match=r"hamming .*weights"):
        system.apply(created(1, (1.0, 1.0), level=MID))
