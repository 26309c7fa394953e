"""Hold to correct on the page: a held button drives and teaches, a tap is a lesson as ever."""

from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.state import HoldState
from kurt2rt.core.decision.standing import Standing, StandReason
from tests.teacher.page.fake_robot import FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LAPTOP
from tests.teacher.page.screens import on_each_screen

HELD = HoldState(teacher="local", action="spin_left", lesson="local-hold-7", lessons=3, on=True)
BUTTON = "[data-action=spin_left]"


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    a_lesson.begin(standing=Standing())
    return a_lesson


def finger_down(lesson: Lesson) -> None:
    """Put a finger on the button, and wait until its action is held."""
    lesson.phone.finger_down(*lesson.phone.middle(BUTTON))
    lesson.phone.wait(lambda: lesson.told("hold"), "the action is held")


def test_held_button_holds_its_action_until_the_finger_lifts(lesson: Lesson) -> None:
    finger_down(lesson)
    assert lesson.phone.has(f"{BUTTON}.held")
    lesson.phone.wait(lambda: len(lesson.told("hold")) > 5, "it is sent again and again")
    lesson.phone.finger_up()
    lesson.phone.wait(lambda: lesson.robot.told_of("let_go"), "it is released")
    count = len(lesson.told("hold"))
    lesson.phone.pass_time(0.2)
    assert set(lesson.told("hold")) == {"spin_left"}
    assert len(lesson.told("hold")) == count
    assert lesson.told("/correct") == [], "a hold is no tap"
    assert not lesson.phone.has(f"{BUTTON}.held")


def test_tap_on_a_button_is_a_late_correction(lesson: Lesson) -> None:
    lesson.phone.touch(BUTTON)
    lesson.phone.wait(lambda: lesson.robot.told_of("/correct"), "a correction")
    (told,) = lesson.robot.told_of("/correct")
    assert (told[1], told[3]) == ("spin_left", True)
    lesson.phone.pass_time(0.4)
    assert lesson.told("hold") == []


def with_stand(robot: FakeRobot) -> None:
    robot.greeting = replace(robot.greeting, actions=("forward", "stand"))


def test_standing_is_taught_by_a_second_touch_and_never_held(a_lesson: Lesson) -> None:
    a_lesson.begin(with_stand, standing=Standing())
    phone, stand = a_lesson.phone, "[data-action=stand]"
    phone.touch(stand)
    phone.wait(lambda: phone.has("#said.asks"), "the page asks for another touch")
    assert a_lesson.told("/correct") == []
    phone.touch(stand)
    phone.wait(lambda: a_lesson.told("/correct") == ["stand"], "the second touch teaches")
    phone.wait(lambda: not phone.has(".pending, .turned, [aria-busy=true]"), "it may be taught again")
    phone.finger_down(*phone.middle(stand))
    phone.pass_time(0.6)
    phone.finger_up()
    assert a_lesson.told("hold") == []


def test_page_counts_the_lessons_and_undoes_them_together(lesson: Lesson) -> None:
    finger_down(lesson)
    lesson.show(hold=HELD, by_hand=True)
    lesson.reads("#said", "spin left is held, lessons: 3")
    lesson.phone.show("17-held")
    lesson.phone.finger_up()
    lesson.show(hold=replace(HELD, lessons=4, on=False), by_hand=False)
    lesson.reads("#said", "spin left was held, lessons: 4")
    on_each_screen(lesson.phone, "17-lessons-by-holding")
    with lesson.phone.in_the_dark():
        lesson.phone.show("17-lessons-by-holding-dark")
    lesson.phone.touch("#undo-hold")
    lesson.phone.wait(lambda: lesson.told("/undo") == ["local-hold-7"], "all are undone")
    assert not lesson.phone.shows("#undo-hold")


@pytest.mark.parametrize(
    "end",
    [
        "dispatchEvent(new Event('blur'))",
        "document.querySelector('#tab-drive').click()",
        pytest.param("dispatchEvent(new Event('pagehide'))", marks=pytest.mark.deep),
    ],
    ids=["blur", "tab", "pagehide"],
)
def test_hold_ends_with_the_page_and_does_not_come_back(lesson: Lesson, end: str) -> None:
    finger_down(lesson)
    lesson.phone.run(end)
    lesson.phone.wait(lambda: lesson.robot.told_of("let_go"), "it is released")
    count = len(lesson.told("hold"))
    lesson.phone.pass_time(0.2)
    assert len(lesson.told("hold")) == count
    lesson.phone.finger_up()
    lesson.phone.run("document.querySelector('#tab-teach').click()")


def test_long_touch_on_a_stopped_robot_is_a_tap(lesson: Lesson) -> None:
    lesson.show(standing=Standing(StandReason.STOPPED, True), action=None, left_m_s=0.0, right_m_s=0.0)
    lesson.phone.wait(lambda: lesson.phone.has("#go:enabled"), "it is stopped")
    lesson.phone.finger_down(*lesson.phone.middle(BUTTON))
    lesson.phone.pass_time(0.5)
    lesson.phone.finger_up()
    lesson.phone.wait(lambda: lesson.told("/correct") == ["spin_left"], "a correction")
    assert lesson.told("hold") == []


def test_digit_key_held_holds_and_tapped_corrects(lesson: Lesson) -> None:
    first = lesson.robot.greeting.actions[0]
    lesson.phone.turn(LAPTOP, touch=False)
    lesson.phone.key("keyDown", "Digit1")
    lesson.phone.wait(lambda: lesson.told("hold"), "the action is held")
    lesson.phone.key("keyUp", "Digit1")
    lesson.phone.wait(lambda: lesson.robot.told_of("let_go"), "it is released")
    assert lesson.told("/correct") == []
    lesson.phone.key("keyDown", "Digit1")
    lesson.phone.key("keyUp", "Digit1")
    lesson.phone.wait(lambda: lesson.told("/correct") == [first], "a correction")
    assert set(lesson.told("hold")) == {first}
