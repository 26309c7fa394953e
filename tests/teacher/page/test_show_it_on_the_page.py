"""Show it on the page: what was driven by hand is seen as actions, and taught once the teacher has confirmed it."""

from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.state import ShownState
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.standing import Standing, StandReason
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.screens import on_each_screen

SHOWN = ShownState("local", 91, ("forward", "spin_left", "forward"), (100, 280, 340), (180, 60, 240))


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    a_lesson.begin(shown=SHOWN, stopped=ActiveStop(StopReason.LET_GO, "local"), left_m_s=0.0, right_m_s=0.0)
    a_lesson.phone.touch("#tab-drive")
    a_lesson.phone.wait(lambda: a_lesson.phone.shows("#shown"), "the drive is offered")
    return a_lesson


def test_shown_segments_are_taught_but_for_those_left_out(lesson: Lesson) -> None:
    phone = lesson.phone
    assert "Teach" in phone.text("#teach-shown")
    on_each_screen(phone, "18-show-it")
    phone.touch("#shown-list button:nth-child(2)")
    assert phone.text("#teach-shown") == "Teach 2 of 3"
    phone.touch("#teach-shown")
    phone.wait(lambda: lesson.robot.told_of("/shown"), "the confirmation is sent")
    assert lesson.robot.told_of("/shown") == [("/shown", 91, (0, 2))]


def test_not_now_is_not_asked_again_at_the_next_stand(lesson: Lesson) -> None:
    lesson.phone.touch("#drop-shown")
    lesson.show(standing=Standing(), stopped=None, left_m_s=0.3, right_m_s=0.3)
    lesson.reads("#sentence", "RLA 1 ")
    stop = ActiveStop(StopReason.SAID_STOP, "local")
    stands = Standing(StandReason.STOPPED, needs_resume=True, stop=stop)
    lesson.show(standing=stands, stopped=stop, left_m_s=0.0, right_m_s=0.0)
    lesson.reads("#sentence", "Stands")
    assert not lesson.phone.shows("#shown")
    lesson.show(shown=replace(SHOWN, press_id=92))
    lesson.phone.wait(lambda: lesson.phone.shows("#shown"), "another drive is offered")
