"""Why the robot does what it does, asked from the page."""

import pytest

from tests.runs.explain.helpers import facts, level, story
from tests.teacher.page.fake_robot import FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.screens import on_each_screen

NEAREST, RUNNER_UP = story(1, (120.0, 80.0), "forward", 5.0), story(2, (90.0, 88.0), "spin_left", 34.0)
DECIDED = facts(level((123.0, 84.0), NEAREST, RUNNER_UP))


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    def prepare(robot: FakeRobot) -> None:
        robot.decided = DECIDED

    a_lesson.begin(prepare)
    return a_lesson


def test_a_touch_on_its_sentence_tells_why_it_does_so(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.touch("#sentence")
    lesson.reads("#explanation-lines", "The runner-up of 2 is RLA 2 (spin_left) at 34")
    assert phone.text("#explanation-says") == "forward"
    rows = phone.text("#explanation-features").splitlines()
    assert len(rows) == 3  # a heading, and both features, the one that differs more first
    assert rows[1].split()[1:] == ["84", "80", "64", "%"]
    on_each_screen(phone, "15-why")
    phone.touch("#close-explanation")
    assert not phone.shows("#explanation")


def test_refresh_asks_again_and_stop_stays_free(lesson: Lesson) -> None:
    phone = lesson.phone
    lesson.robot.decided = facts(level((123.0, 84.0), NEAREST, RUNNER_UP), action="back")
    phone.key("keyDown", "KeyY")
    phone.key("keyUp", "KeyY")
    lesson.reads("#explanation-says", "back")
    lesson.robot.decided = facts(level((123.0, 84.0), NEAREST, RUNNER_UP), action="spin_left")
    phone.touch("#explain-again")
    lesson.reads("#explanation-says", "spin_left")
    phone.touch("#stop")
    phone.wait(lambda: ("stop",) in lesson.robot.told, "the robot is stopped")
    phone.touch("#link")
    assert not phone.shows("#explanation")  # one table at a time


def test_a_robot_that_does_not_answer_is_said_so(lesson: Lesson) -> None:
    lesson.robot.silent = True
    lesson.phone.touch("#sentence")
    lesson.reads("#explanation-says", "no answer")
    lesson.robot.silent, lesson.robot.decided = False, None
    lesson.phone.touch("#explain-again")
    lesson.reads("#explanation-says", "nothing was decided yet")
