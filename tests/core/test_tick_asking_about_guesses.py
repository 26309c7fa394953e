"""Robot that asks about lessons of holds that all their neighbours contradict, while it is taught."""

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.lesson_history import DERIVED, hold_id
from kurt2rt.core.rla.phase import Phase
from tests.core.rla.helpers import created
from tests.core.test_tick import NARROW_SHARE, RADIUS, Corridor
from tests.teacher.helpers import set_phase, teach

GUESSED_AT, BETWEEN = 110, 114
"""Counts of the held lesson, and counts nearest to it that are outside its narrow radius."""


def taught(*, asks: bool = True) -> Corridor:
    """Return a robot with five answers and, between them, a lesson of a hold that contradicts them."""
    corridor = Corridor(asks_about_guesses=asks)
    for counts in (100, 120, 140, 160, 180):
        corridor.run(counts, teach("forward", f"answer-{counts}"))
    vector = tuple(corridor.run(GUESSED_AT).situation.vector.tolist())
    corridor.level.apply(created(6, vector, "back", command_id=f"{hold_id('Ann', 1)}{DERIVED}7"))
    return corridor


def cause_between(corridor: Corridor) -> DecisionCause:
    """Return why the robot drives or stands between the narrow radius and R."""
    record = corridor.run(BETWEEN)
    match = record.decision.match
    assert match is not None
    assert match.rla.rla_id == 6
    assert NARROW_SHARE * RADIUS < match.distance < RADIUS
    return record.decision.cause


def test_taught_robot_asks_about_a_guess() -> None:
    assert cause_between(taught()) is DecisionCause.UNKNOWN


def test_robot_without_the_setting_drives_by_a_guess() -> None:
    assert cause_between(taught(asks=False)) is DecisionCause.RLA


def test_robot_of_a_later_phase_drives_by_a_guess() -> None:
    corridor = taught()
    corridor.run(GUESSED_AT, set_phase(Phase.REINFORCEMENT))
    assert cause_between(corridor) is DecisionCause.RLA


def test_answer_that_agrees_with_a_guess_ends_questions() -> None:
    corridor = taught()
    assert cause_between(corridor) is DecisionCause.UNKNOWN
    corridor.run(BETWEEN, teach("back", "confirms"))
    record = corridor.run(GUESSED_AT - 4)
    assert record.decision.cause is DecisionCause.RLA
    assert record.decision.action == "back"
