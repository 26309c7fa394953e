"""Competitors and neighbours of an RLA."""

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created


def system_of(*events: TeachingEvent) -> RlaSystem:
    system = RlaSystem(2, 5.0, others={CRITIC: Space(2, 1.0)})
    system.apply_all(events)
    return system


def rla_id_of(system: RlaSystem, rla_id: int) -> Rla:
    rla = system.get(rla_id)
    assert rla is not None
    return rla


def around(system: RlaSystem, rla_id: int, count: int) -> list[int]:
    return [rla.rla_id for rla in system.neighbours(rla_id_of(system, rla_id), count)]


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
