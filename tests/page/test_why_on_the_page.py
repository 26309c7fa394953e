"""Why the robot does what it does, asked from the page."""

from collections.abc import Iterator

import pytest
from anyio.from_thread import start_blocking_portal

from tests.explain.helpers import facts, level, story
from tests.page.fake_robot import A_PLACE
from tests.page.phone import LANDSCAPE, LAPTOP, PORTRAIT, SMALL, Phone
from tests.page.test_browser import assert_handy, show_on
from tests.page.test_critic_on_the_page import Lesson
from tests.page.test_served_page import TOKEN, served

SIZES = (PORTRAIT, SMALL, LANDSCAPE, LAPTOP)
NEAREST, RUNNER_UP = story(1, (120.0, 80.0), "forward", 5.0), story(2, (90.0, 88.0), "spin_left", 34.0)
DECIDED = facts(level((123.0, 84.0), NEAREST, RUNNER_UP))


@pytest.fixture
def lesson(a_phone: Phone) -> Iterator[Lesson]:
    with start_blocking_portal() as portal, portal.wrap_async_context_manager(served()) as page:
        page.robot.decided = DECIDED
        lesson = Lesson(a_phone, portal, page.robot)
        lesson.show(teacher="local", place=A_PLACE)
        pictures = portal.start_task_soon(show_on, page.robot)
        try:
            a_phone.turn(PORTRAIT)
            a_phone.open(f"http://127.0.0.1:{page.port}/pair?token={TOKEN}")
            lesson.reads("#sentence", "RLA 1 does forward")
            yield lesson
        finally:
            pictures.cancel()


def test_a_touch_on_its_sentence_tells_why_it_does_so(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.touch("#sentence")
    lesson.reads("#explanation-lines", "The runner-up of 2 is RLA 2 (spin_left) at 34")
    assert phone.text("#explanation-says") == "forward"
    rows = phone.text("#explanation-features").splitlines()
    assert len(rows) == 3  # a heading, and both features, the one that differs more first
    assert rows[1].endswith("84 80 64 %")
    for size in SIZES:
        phone.turn(size, touch=size != LAPTOP)
        phone.show(f"15-why-{size[0]}x{size[1]}")
        assert_handy(phone, size, "teach")
    phone.turn(PORTRAIT)
    phone.touch("#close-explanation")
    assert not phone.find("#explanation").is_displayed()


def test_it_is_asked_anew_when_the_teacher_wants_it_and_stop_stays_free(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.key("keyDown", "KeyY")
    phone.key("keyUp", "KeyY")
    lesson.reads("#explanation-says", "forward")
    lesson.robot.decided = facts(level((123.0, 84.0), NEAREST, RUNNER_UP), action="spin_left")
    phone.touch("#explain-again")
    lesson.reads("#explanation-says", "spin_left")
    phone.touch("#stop")
    phone.wait(lambda: ("stop",) in lesson.robot.told, "the robot is stopped")
    phone.touch("#link")
    assert not phone.find("#explanation").is_displayed()  # one table at a time


def test_a_robot_that_does_not_answer_is_said_so(lesson: Lesson) -> None:
    lesson.robot.silent = True
    lesson.phone.touch("#sentence")
    lesson.reads("#explanation-says", "no answer")
    lesson.robot.silent, lesson.robot.decided = False, None
    lesson.phone.touch("#explain-again")
    lesson.reads("#explanation-says", "nothing was decided yet")
