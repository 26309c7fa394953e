"""Contradictions: RLAs whose five nearest neighbours all do something else."""

import pytest

from behaviors.action_groups import action_groups
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.contradiction import find_contradiction
from kurt2rt.core.rla.events import ActionWithdrawn
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, origin, replaced

GROUPS = action_groups("basic")
SLIP = 6


@pytest.fixture
def system() -> RlaSystem:
    """Return five RLAs that drive ahead and, between them, one that whirls."""
    system = RlaSystem(1, radius=10.0)
    actions = ("forward", "bear_left", "forward", "bear_right", "forward", "whirl_left")
    for rla_id, (condition, action) in enumerate(zip((1.0, 2.0, 3.0, 5.0, 6.0, 4.1), actions, strict=True), 1):
        system.apply(created(rla_id, (condition,), action))
    return system


def contradicted(system: RlaSystem) -> list[int]:
    return [each.rla_id for each in system.rlas if find_contradiction(system, each, GROUPS) is not None]


def test_contradiction_names_neighbours_nearest_first(system: RlaSystem) -> None:
    slip = system.get(SLIP)
    assert slip is not None
    found = find_contradiction(system, slip, GROUPS)
    assert found is not None
    assert [each.rla_id for each in found.neighbours] == [4, 3, 5, 2, 1]
    assert found.actions == ("bear_right", "forward", "bear_left")
    assert contradicted(system) == [SLIP]


def test_contradiction_ends_when_one_neighbour_agrees(system: RlaSystem) -> None:
    system.apply(replaced(1, "whirl_left", "forward"))
    assert contradicted(system) == []


def test_contradiction_needs_five_neighbours_with_an_action(system: RlaSystem) -> None:
    system.apply(ActionWithdrawn(5, "forward", origin("ask-again")))
    assert contradicted(system) == []
    system.apply(created(7, (7.0,), "forward"))
    assert contradicted(system) == [SLIP]


def test_contradiction_is_within_one_behaviour_and_level() -> None:
    system = RlaSystem(1, radius=10.0, others={MID: Space(1, 10.0)})
    for place in range(1, 6):
        system.apply(created(2 * place, (float(place),), "forward", behaviour="turn_left"))
        system.apply(created(2 * place + 1, (float(place),), "forward", level=MID))
    system.apply(created(20, (2.5,), "whirl_left", behaviour="turn_right"))
    system.apply(created(21, (2.5,), "whirl_left", level=MID))
    assert contradicted(system) == []


def test_neighbours_of_the_same_hold_can_be_passed_over(system: RlaSystem) -> None:
    hold = hold_id("Ann", 3)
    system.apply(created(7, (4.2,), "whirl_right", command_id=f"{hold}{DERIVED}50"))
    system.apply(created(8, (4.3,), "whirl_right", command_id=f"{hold}{DERIVED}60"))
    held = system.get(8)
    assert held is not None
    assert find_contradiction(system, held, GROUPS) is None
    found = find_contradiction(system, held, GROUPS, of_other_presses=True)
    assert found is not None
    assert [each.rla_id for each in found.neighbours] == [6, 4, 3, 5, 2]
