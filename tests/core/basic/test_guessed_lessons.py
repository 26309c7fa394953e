"""Guessed lessons: lessons of holds that all their neighbours contradict have a narrow radius."""

import numpy as np
import pytest

from behaviors.action_groups import action_groups
from kurt2rt.core.basic.guessed_lessons import GuessedLessons
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, replaced

RADIUS, NARROW = 10.0, 0.05
GUESS = 6
HELD = f"{hold_id('Ann', 1)}{DERIVED}700"


@pytest.fixture
def system() -> RlaSystem:
    """Return five RLAs that drive ahead and, between them, one that a hold taught to whirl."""
    return system_with(HELD)


def system_with(command_id: str) -> RlaSystem:
    system = RlaSystem(1, radius=RADIUS)
    for rla_id, place in enumerate((1.0, 2.0, 3.0, 6.0, 7.0), 1):
        system.apply(created(rla_id, (place,)))
    system.apply(created(GUESS, (4.0,), "whirl_left", command_id=command_id))
    return system


def guesses_of(system: RlaSystem) -> GuessedLessons:
    return GuessedLessons(system, action_groups("basic"), NARROW)


def match_at(system: RlaSystem, place: float) -> Match:
    match = system.match(np.array([place]))
    assert match is not None
    return match


def test_guess_answers_within_its_narrow_radius_only(system: RlaSystem) -> None:
    guesses = guesses_of(system)
    far, near = match_at(system, 4.6), match_at(system, 4.4)
    assert far.rla.rla_id == near.rla.rla_id == GUESS
    assert guesses.narrowed(far) == far._replace(radius=NARROW * RADIUS)
    assert not guesses.narrowed(far).known
    assert guesses.narrowed(near) is near


def test_answer_is_never_a_guess() -> None:
    system = system_with("Ann-7")
    match = match_at(system, 4.6)
    assert guesses_of(system).narrowed(match) is match


def test_guess_that_a_neighbour_confirms_is_none(system: RlaSystem) -> None:
    guesses, match = guesses_of(system), match_at(system, 4.6)
    assert guesses.narrowed(match) is not match
    system.apply(created(7, (4.6,), "whirl_left"))
    confirmed = match_at(system, 4.2)
    assert confirmed.rla.rla_id == GUESS
    assert guesses.narrowed(confirmed) is confirmed


def test_guess_that_is_corrected_is_none(system: RlaSystem) -> None:
    guesses = guesses_of(system)
    assert guesses.narrowed(match_at(system, 4.6)) is not match_at(system, 4.6)
    system.apply(replaced(GUESS, "forward", "whirl_left"))
    match = match_at(system, 4.6)
    assert guesses.narrowed(match) is match


def test_match_outside_the_radius_stays_as_it_is(system: RlaSystem) -> None:
    system.radius_share = 0.05
    match = match_at(system, 4.8)
    assert not match.known
    assert guesses_of(system).narrowed(match) is match
