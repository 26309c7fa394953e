"""Guessed lessons: lessons of holds that all neighbours contradict; a robot without a teacher passes over them."""

import numpy as np
import pytest

from behaviors.action_groups import action_groups
from kurt2rt.core.rla.contradiction import GuessedLessons
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created

GUESS = 6
HELD = f"{hold_id('Ann', 1)}{DERIVED}700"


def system_with(command_id: str) -> RlaSystem:
    """Return five answers that drive ahead and, between them, a lesson of this command that whirls."""
    system = RlaSystem(1, radius=10.0)
    for rla_id, place in enumerate((1.0, 2.0, 3.0, 6.0, 7.0), 1):
        system.apply(created(rla_id, (place,)))
    system.apply(created(GUESS, (4.0,), "whirl_left", command_id=command_id))
    system.is_guess = GuessedLessons(system, action_groups("basic")).includes
    return system


@pytest.fixture
def system() -> RlaSystem:
    return system_with(HELD)


def nearest(system: RlaSystem, place: float, *, taught: bool = False) -> tuple[int, float, int]:
    """Return id and distance of the RLA that answers at a place, and the id of the runner-up."""
    match = system.match(np.array([place]), include_withdrawn=taught)
    assert match is not None
    assert match.runner_up is not None
    return match.rla.rla_id, match.distance, match.runner_up.rla_id


def test_lessons_of_one_hold_do_not_confirm_each_other(system: RlaSystem) -> None:
    system.apply(created(7, (4.5,), "whirl_left", command_id=f"{hold_id('Ann', 1)}{DERIVED}710"))
    assert nearest(system, 4.25) == (3, 1.25, 4)
