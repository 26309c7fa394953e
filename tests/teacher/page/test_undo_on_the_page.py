"""Undo on the page: the first touch names the lesson, and whether the last press gave one."""

import pytest

from kurt2rt.core.decision.standing import Standing
from tests.teacher.page.fake_robot import A_LESSON, FakeRobot
from tests.teacher.page.lesson import Lesson


def with_a_lesson(robot: FakeRobot) -> None:
    robot.newest_lessons = (A_LESSON,)


@pytest.mark.parametrize(
    ("answered", "says"),
    [
        ({"row": 7, "lesson": A_LESSON.command_id}, "undo RLA"),
        ({"row": 7}, "undo RLA"),  # of an earlier robot
        ({}, "taught nothing"),
    ],
)
def test_first_touch_tells_a_press_that_taught_nothing(
    a_lesson: Lesson, answered: dict[str, object], says: str
) -> None:
    a_lesson.begin(with_a_lesson, standing=Standing())
    a_lesson.robot.answers_with = answered
    a_lesson.phone.touch("[data-action=spin_left]")
    a_lesson.phone.wait(lambda: a_lesson.phone.has("#said.saved"), "the press is answered")
    a_lesson.phone.touch("#undo-last")
    a_lesson.phone.wait(lambda: a_lesson.phone.has("#said.asks"), "the page asks for another touch")
    assert says in a_lesson.phone.text("#said")
    a_lesson.phone.touch("#undo-last")
    a_lesson.phone.wait(lambda: a_lesson.told("undo") == [A_LESSON.command_id], "the named lesson is undone")
