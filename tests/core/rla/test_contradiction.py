"""Contradictions: RLAs whose five nearest neighbours all do something else; lessons of holds among them are guesses."""

import numpy as np
import pytest

from behaviors.action_groups import action_groups
from kurt2rt.core.rla.contradiction import GuessedLessons, find_contradiction
from kurt2rt.core.rla.events import ActionWithdrawn
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
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


def test_lessons_of_one_hold_do_not_confirm_each_other() -> None:
    system = RlaSystem(1, radius=10.0)
    for rla_id, place in enumerate((1.0, 2.0, 3.0, 6.0, 7.0), 1):
        system.apply(created(rla_id, (place,)))
    for rla_id, place, tick in ((6, 4.0, 700), (7, 4.5, 710)):
        command_id = f"{hold_id('Ann', 1)}{DERIVED}{tick}"
        system.apply(created(rla_id, (place,), "whirl_left", command_id=command_id))
    system.is_guess = GuessedLessons(system, GROUPS).includes
    match = system.match(np.array([4.25]), include_withdrawn=False)
    assert match is not None
    assert match.runner_up is not None
    assert (match.rla.rla_id, match.distance, match.runner_up.rla_id) == (3, 1.25, 4)
