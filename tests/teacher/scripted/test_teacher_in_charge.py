"""TeacherInCharge: it takes over, follows with its hand, and gives control back."""

from collections.abc import Callable
from itertools import pairwise

from kurt2rt.core.teaching.commands import Command, HoldAction, Stop
from kurt2rt.teacher.scripted.basic_teacher import TeacherView
from kurt2rt.teacher.scripted.person import TaskSense
from kurt2rt.teacher.scripted.teacher_in_charge import Charge, Offer, TeacherInCharge
from tests.teacher.scripted.test_person import (
    DIFFERENT_TICKS,
    FAR,
    GROUPS,
    LINK_TICKS,
    MISTAKE_TICKS,
    NEAR,
    PERIOD_S,
    PICTURE_TICKS,
    QUESTION_TICKS,
    SPEEDS,
    NearIsB,
    asking,
    doing,
    limits,
)

AGREES_TICKS, HAND_TICKS = 200, 30


def teacher(charge: Charge) -> TeacherInCharge:
    sense = TaskSense(NearIsB(), tuple(GROUPS), GROUPS, SPEEDS)
    return TeacherInCharge(limits(), sense, charge, period_s=PERIOD_S, seed=1, session="s")


def given(
    teacher: TeacherInCharge, ticks: int, view: TeacherView, offer: Callable[[int], Offer] = lambda _: Offer()
) -> dict[int, Command]:
    """Return the commands by the tick in which they reach the robot, counted from 1."""
    heard: dict[int, Command] = {}
    for tick in range(1, ticks + 1):
        teacher.offer = offer(tick)
        command = teacher.update(view._replace(tick=tick))
        if command is not None:
            heard[tick] = command
    return heard


def test_question_is_answered_by_a_hold_after_the_delay() -> None:
    held = given(teacher(Charge.BY_ROBOT), 400, asking(NEAR))
    first = min(held)
    assert QUESTION_TICKS + 2 * LINK_TICKS <= first <= QUESTION_TICKS + 2 * (LINK_TICKS + PICTURE_TICKS)
    assert all(isinstance(each, HoldAction) and each.action == "b" for each in held.values())
    ticks = list(held)
    assert {after - before for before, after in pairwise(ticks)} == {PICTURE_TICKS}


def test_mistake_is_taken_over_only_by_a_teacher_who_decides() -> None:
    held = given(teacher(Charge.BY_TEACHER), 300, doing("a", NEAR))
    assert min(held) >= DIFFERENT_TICKS + MISTAKE_TICKS
    assert given(teacher(Charge.BY_ROBOT), 300, doing("a", NEAR)) == {}


def test_teacher_gives_back_after_two_seconds_of_agreement() -> None:
    agrees_from = 400
    held = given(
        teacher(Charge.BY_TEACHER), 800, doing("a", NEAR), lambda tick: Offer("b" if tick >= agrees_from else "a")
    )
    stop = next(tick for tick, command in held.items() if isinstance(command, Stop))
    assert agrees_from + AGREES_TICKS <= stop <= agrees_from + AGREES_TICKS + 2 * (LINK_TICKS + PICTURE_TICKS)


def test_robot_that_is_ready_gets_control_back_by_the_hand() -> None:
    ready_from = 400
    held = given(teacher(Charge.BY_ROBOT), 500, asking(NEAR), lambda tick: Offer("a", is_ready=tick >= ready_from))
    stop = next(tick for tick, command in held.items() if isinstance(command, Stop))
    assert ready_from + HAND_TICKS <= stop <= ready_from + HAND_TICKS + 2 * (LINK_TICKS + PICTURE_TICKS)


def test_demonstration_ends_as_soon_as_the_robot_says_so() -> None:
    held = given(teacher(Charge.BY_TEACHER), 500, asking(FAR), lambda tick: Offer(None, is_ready=tick >= 300))
    assert any(isinstance(command, Stop) for command in held.values())
    held = given(teacher(Charge.BY_TEACHER), 500, asking(FAR))
    assert not any(isinstance(command, Stop) for command in held.values())


def test_robot_that_is_being_fitted_asks_nothing() -> None:
    assert given(teacher(Charge.BY_ROBOT), 400, asking(NEAR), lambda _: Offer("a", is_fitting=True)) == {}


def test_teacher_who_always_drives_never_gives_back() -> None:
    held = given(teacher(Charge.ALWAYS), 600, doing("b", NEAR), lambda _: Offer("b", is_ready=True))
    assert {type(each) for each in held.values()} == {HoldAction}


def test_teacher_who_names_actions_sends_no_command() -> None:
    names = teacher(Charge.NAMES)
    assert given(names, 300, doing("a", NEAR)) == {}
    assert names.hand == "b"


def test_hand_follows_the_right_action_after_its_delay() -> None:
    holds = teacher(Charge.ALWAYS)
    given(holds, 300, doing("a", NEAR))
    assert holds.hand == "b"
    for tick in range(301, 301 + HAND_TICKS):
        holds.update(doing("a", FAR)._replace(tick=tick))
    assert holds.hand == "b"
    for tick in range(301 + HAND_TICKS, 301 + HAND_TICKS + LINK_TICKS + 2 * PICTURE_TICKS):
        holds.update(doing("a", FAR)._replace(tick=tick))
    assert holds.hand == "a"
