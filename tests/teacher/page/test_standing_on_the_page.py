"""The page of a robot that stands: the headline says why and what to touch, and GO stands out where it waits for it."""

import pytest

from kurt2rt.core.decision.standing import Standing, StandReason, question_text
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LAPTOP, PORTRAIT, SMALL

SIZES = (PORTRAIT, SMALL, LAPTOP)
LATCHED = Standing(StandReason.COMPUTER_TOO_SLOW, True, stall_s=0.12)
TOUCHES = Standing(StandReason.FRONT_BUMPER, asks=True)
_CUT = """
const line = document.querySelector('#sentence');
return line.scrollHeight > line.clientHeight + 1 || line.scrollWidth > line.clientWidth + 1;
"""
_GO = "const go = document.querySelector('#go'); return [go.disabled, getComputedStyle(go).outlineStyle];"


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    a_lesson.begin(standing=Standing())
    return a_lesson


def look(lesson: Lesson, name: str) -> None:
    """Its headline is not cut on any screen."""
    for size in SIZES:
        lesson.phone.turn(size, touch=size != LAPTOP)
        lesson.phone.show(f"14-{name}-{size[0]}x{size[1]}")
        assert not lesson.phone.run(_CUT), size
    lesson.phone.turn(PORTRAIT)


def test_a_latched_guard_goes_before_the_rule_that_would_drive(lesson: Lesson) -> None:
    phone = lesson.phone
    assert phone.run(_GO) == [True, "none"]
    lesson.show(standing=LATCHED, left_m_s=0.0, right_m_s=0.0)  # cause and action stay those of the rule
    lesson.reads("#sentence", "Stands: the computer was too slow for 0.1 s. GO lets it drive on")
    assert phone.run(_GO) == [False, "solid"]
    look(lesson, "latched")
    phone.touch("#go")
    phone.wait(lambda: lesson.robot.told.count(("/resume",)) == 1, "the robot may drive on")
    lesson.show(standing=Standing())
    lesson.reads("#sentence", "RLA 1")
    assert phone.run(_GO) == [True, "none"]


def test_robot_at_a_bumper_asks_and_is_corrected(lesson: Lesson) -> None:
    phone = lesson.phone
    stands = {"cause": "touches", "action": None, "rla": None, "left_m_s": 0.0, "right_m_s": 0.0}
    lesson.show(standing=TOUCHES, nearest=1, nearest_action="forward", distance=90.0, bumpers=7, **stands)
    lesson.reads("#sentence", question_text(TOUCHES))
    assert "RLA 1, forward" in phone.text("#nearest")
    assert phone.run("return document.querySelector('#why').className;") == "stands asks"
    assert phone.run(_GO) == [True, "none"]
    look(lesson, "touches")
    phone.touch("[data-action=spin_left]")
    phone.wait(lambda: lesson.told("/correct") == ["spin_left"], "a correction")
    assert lesson.told("/answer") == []
