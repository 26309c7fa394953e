"""Competitors and neighbours of an RLA."""

import numpy as np
import pytest

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, deleted, replaced, undone, withdrawn


def system_of(*events: TeachingEvent) -> RlaSystem:
    system = RlaSystem(2, 5.0, others={CRITIC: Space(2, 1.0)})
    system.apply_all(events)
    return system


def rla_id_of(system: RlaSystem, rla_id: int) -> Rla:
    rla = system.get(rla_id)
    assert rla is not None
    return rla


def competing(system: RlaSystem, rla_id: int) -> list[int]:
    return [rla.rla_id for rla in system.competitors(rla_id_of(system, rla_id))]


def around(system: RlaSystem, rla_id: int, count: int) -> list[int]:
    return [rla.rla_id for rla in system.neighbours(rla_id_of(system, rla_id), count)]


def test_competitors_follow_all_changes() -> None:
    system = system_of(created(1, (0.0, 0.0)), created(2, (0.0, 0.0)), created(3, (0.0, 0.0)))
    system.apply(replaced(2, "back", "forward"))
    system.apply(withdrawn(3))
    assert [rla.action for rla in system.competitors(rla_id_of(system, 1))] == ["forward", "back", "ask"]
    gone = rla_id_of(system, 1)
    system.apply(deleted(1))
    assert competing(system, 2) == [2, 3]
    assert system.competitors(gone) == system.competitors(rla_id_of(system, 2))  # those on its place
    system.apply(undone("deletion-1"))
    assert competing(system, 3) == [1, 2, 3]


def test_neighbours_have_other_conditions_nearest_first() -> None:
    system = system_of(
        created(1, (0.0, 0.0)),
        created(2, (0.0, 0.0), "back"),
        created(3, (3.0, 0.0)),
        created(4, (-1.0, 0.0)),
        created(5, (3.0, 0.0), "left"),
        created(6, (0.0, 9.0)),
        created(7, (0.1, 0.0), behaviour="turn_left"),
        created(8, (0.1, 0.0), "bad", level=CRITIC),
    )
    assert around(system, 1, 9) == around(system, 2, 9) == [4, 3, 5, 6]  # of equally near ones the older first
    assert around(system, 1, 2) == [4, 3]
    assert around(system, 7, 9) == around(system, 8, 9) == around(system, 1, 0) == []


def test_neighbours_of_a_deleted_rla_are_found() -> None:
    system = system_of(created(1, (0.0, 0.0)), created(2, (1.0, 0.0)))
    gone = rla_id_of(system, 1)
    system.apply(deleted(1))
    assert [rla.rla_id for rla in system.neighbours(gone, 5)] == [2]


@pytest.mark.parametrize(("weights", "nearest"), [((1.0, 1.0), 2), ((1.0, 0.1), 3)])
def test_neighbours_use_the_weights_of_the_level(weights: tuple[float, float], nearest: int) -> None:
    for level in ("basic", CRITIC):
        space = Space(2, 1.0, np.array(weights))
        system = RlaSystem(2, 1.0, space.weights, others={CRITIC: space})
        for rla_id, condition in {1: (0.0, 0.0), 2: (3.0, 0.0), 3: (0.0, 9.0)}.items():
            system.apply(created(rla_id, condition, level=level))
        assert around(system, 1, 1) == [nearest]
