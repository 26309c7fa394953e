"""Contradictions: RLAs whose five nearest neighbours all do something else."""

import pytest

from behaviors.action_groups import action_groups
from kurt2rt.core.rla.contradiction import find_contradiction
from kurt2rt.core.rla.events import ActionWithdrawn
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, origin

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


def test_contradiction_needs_five_neighbours_with_an_action(system: RlaSystem) -> None:
    system.apply(ActionWithdrawn(5, "forward", origin("ask-again")))
    assert contradicted(system) == []
    system.apply(created(7, (7.0,), "forward"))
    assert contradicted(system) == [SLIP]
