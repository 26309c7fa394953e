"""A page that keeps its buttons where they are: no answer and no row of actions moves them under a finger."""

from dataclasses import replace

import pytest

from kurt2rt.core.decision.standing import Standing
from tests.teacher.page.fake_robot import A_HELLO, FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LANDSCAPE, LAPTOP, PORTRAIT, SMALL
from tests.teacher.page.test_critic_on_the_page import ACTIONS

_TOPS = """
return [...document.querySelectorAll("#actions button, #rewards button, #tabs button, #go, #stop")]
  .filter((e) => e.checkVisibility()).map((e) => Math.round(e.getBoundingClientRect().top));
"""
_HIDDEN_ROWS = "const e = document.querySelector('#teach'); return e.scrollHeight - e.clientHeight;"
A_LONG_ANSWER = (
    "RLA 10 taught: back; all near it say curve_right, spin_right, forward (RLA 9 first): "
    "undo it if your finger slipped"
)


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    """Return a lesson with all actions of the repertoire that wall following ships with."""

    def prepare(robot: FakeRobot) -> None:
        robot.greeting = replace(A_HELLO, actions=ACTIONS)

    a_lesson.begin(prepare, standing=Standing())
    return a_lesson


@pytest.mark.parametrize("size", [PORTRAIT, SMALL, LANDSCAPE, LAPTOP], ids=["portrait", "small", "landscape", "laptop"])
def test_a_long_answer_moves_no_button(lesson: Lesson, size: tuple[int, int]) -> None:
    phone = lesson.phone
    phone.turn(size, touch=size != LAPTOP)
    phone.middle("#undo-last")  # once the screen is turned
    lesson.robot.refuses = A_LONG_ANSWER
    before = phone.run(_TOPS)
    phone.run("document.querySelector('#praise').click()")
    lesson.reads("#said", A_LONG_ANSWER)
    phone.show(f"20-long-answer-{size[0]}x{size[1]}")
    assert phone.run(_TOPS) == before
    phone.turn(PORTRAIT)


def test_a_phone_shows_all_actions_without_scrolling(lesson: Lesson) -> None:
    phone = lesson.phone
    assert len(phone.texts("#actions button")) == len(ACTIONS)
    assert phone.run(_HIDDEN_ROWS) == 0
    lesson.show(cause="unknown", action=None, rla=None, left_m_s=0.0, right_m_s=0.0)
    phone.show("20-all-actions")
    assert phone.run(_HIDDEN_ROWS) == 0
