"""Guessed lessons: lessons of holds that all neighbours contradict; a robot without a teacher passes over them."""

import numpy as np
import pytest

from behaviors.action_groups import action_groups
from kurt2rt.core.rla.contradiction import GuessedLessons
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, replaced, withdrawn

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


def test_robot_without_a_teacher_passes_over_a_guess(system: RlaSystem) -> None:
    assert nearest(system, 4.25) == (3, 1.25, 4)


def test_robot_with_a_teacher_drives_by_a_guess(system: RlaSystem) -> None:
    assert nearest(system, 4.25, taught=True) == (GUESS, 0.25, 3)


def test_answer_is_never_a_guess() -> None:
    assert nearest(system_with("Ann-7"), 4.25) == (GUESS, 0.25, 3)


def test_system_without_the_predicate_passes_over_nothing(system: RlaSystem) -> None:
    system.is_guess = None
    assert nearest(system, 4.25) == (GUESS, 0.25, 3)


def test_lessons_of_one_hold_do_not_confirm_each_other(system: RlaSystem) -> None:
    system.apply(created(7, (4.5,), "whirl_left", command_id=f"{hold_id('Ann', 1)}{DERIVED}710"))
    assert nearest(system, 4.25) == (3, 1.25, 4)


def test_guess_that_another_press_confirms_answers(system: RlaSystem) -> None:
    assert nearest(system, 4.25)[0] != GUESS
    system.apply(created(7, (4.75,), "whirl_left", command_id=f"{hold_id('Ann', 2)}{DERIVED}900"))
    assert nearest(system, 4.25) == (GUESS, 0.25, 7)


def test_guess_that_is_corrected_answers(system: RlaSystem) -> None:
    assert nearest(system, 4.25)[0] != GUESS
    system.apply(replaced(GUESS, "forward", "whirl_left"))
    assert nearest(system, 4.25) == (GUESS, 0.25, 3)


def test_lesson_with_fewer_than_five_neighbours_is_no_guess(system: RlaSystem) -> None:
    system.apply(withdrawn(1))
    assert nearest(system, 4.25) == (GUESS, 0.25, 3)
