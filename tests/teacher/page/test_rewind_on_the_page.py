"""Rewind on the page: stop, pick the moment that went wrong, touch the action that was right there."""

import pytest

from kurt2rt.core.decision.standing import Standing
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.screens import on_each_screen

DRIVE_FROM, DRIVE_TO, EACH = 1000, 1600, 100
MINUTE = 6000
_PICK = """
const slider = document.querySelector('#rewind-time');
slider.value = arguments[0];
slider.dispatchEvent(new Event('input'));
"""
_TOUCH_AND_STOP = """
window.sent = [];
const { send } = WebSocket.prototype;
WebSocket.prototype.send = function (message) { window.sent.push(message); return send.call(this, message); };
document.querySelector('[data-action=spin_left]').click();
document.querySelector('#stop').dispatchEvent(new PointerEvent('pointerdown'));
document.querySelector('#stop').click();
"""


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    """Return a lesson whose robot drives for 6 s, each second by another RLA."""
    a_lesson.begin(standing=Standing(), tick=DRIVE_FROM, left_m_s=0.3, right_m_s=0.3)
    for tick in range(DRIVE_FROM + EACH, DRIVE_TO + 1, EACH):
        a_lesson.show(tick=tick, rla=tick // EACH, clock_s=tick / EACH)
        a_lesson.reads("#clock", f"0:{tick // EACH}")
    return a_lesson


def enter(lesson: Lesson) -> None:
    lesson.phone.touch("#rewind")
    lesson.phone.wait(lambda: lesson.phone.shows("#rewind-bar"), "the past is shown")
    lesson.show(left_m_s=0.0, right_m_s=0.0)


def test_rewind_stops_the_robot_and_shows_the_past(lesson: Lesson) -> None:
    phone = lesson.phone
    assert phone.shows("#robot-view")
    enter(lesson)
    assert lesson.robot.told_of("stop")
    assert not phone.shows("#why")
    assert phone.shows("#world-view"), "the path is shown"
    assert not phone.shows("#robot-view")
    phone.run(_PICK, -3)
    lesson.reads("#rewind-says", "3.0 s before it stood: RLA 13 ")
    on_each_screen(phone, "17-rewind")
    phone.touch("#rewind-close")
    phone.wait(lambda: phone.shows("#robot-view"), "the view of before is back")
    assert not phone.shows("#world-view")
    phone.wait(lambda: phone.shows("#why"), "the present is shown")


def test_action_touched_in_the_past_corrects_the_picked_tick(lesson: Lesson) -> None:
    enter(lesson)
    lesson.show(tick=DRIVE_TO + MINUTE)  # the teacher thinks
    lesson.phone.run(_PICK, -3)
    lesson.phone.touch("[data-action=spin_left]")
    lesson.phone.wait(lambda: lesson.robot.told_of("/correct"), "the correction is sent")
    (name, action, tick), *more = lesson.robot.told_of("/correct")
    assert (name, action, more) == ("/correct", "spin_left", [])
    assert abs(tick - 1300) < EACH / 2
    assert lesson.phone.shows("#rewind-bar"), "another moment may be wrong, too"


def test_rewind_reaches_the_drive_before_a_question(lesson: Lesson) -> None:
    for second in range(20, 32, 3):
        for later, (ticks, speed_m_s) in enumerate(((2, 0.0), (MINUTE, 0.0), (2, 0.3))):
            assert lesson.robot.state is not None
            lesson.show(
                tick=lesson.robot.state.tick + ticks,
                left_m_s=speed_m_s,
                right_m_s=speed_m_s,
                clock_s=float(second + later),
            )
            lesson.reads("#clock", f"0:{second + later}")
    enter(lesson)
    lesson.phone.run(_PICK, -3)
    lesson.reads("#rewind-says", "s before it stood: RLA 13 ")


def test_then_go_lets_the_robot_drive_on_after_the_lesson(lesson: Lesson) -> None:
    enter(lesson)
    lesson.phone.touch("#rewind-go")
    lesson.phone.touch("[data-action=spin_left]")
    lesson.phone.wait(lambda: lesson.robot.told_of("/resume"), "the robot is told to drive on")
    names = [command[0] for command in lesson.robot.told]
    assert names.index("/correct") < names.index("/resume")
    lesson.phone.wait(lambda: lesson.phone.shows("#why"), "the present is shown")


def test_then_go_does_not_lift_a_stop_after_the_touch(lesson: Lesson) -> None:
    enter(lesson)
    lesson.phone.touch("#rewind-go")
    before = len(lesson.robot.told_of("stop"))
    # Both in one turn of the page's loop, so that the stop comes before the answer to the lesson.
    lesson.phone.run(_TOUCH_AND_STOP)
    lesson.phone.wait(lambda: lesson.robot.told_of("/correct"), "the lesson is given")
    lesson.phone.wait(lambda: len(lesson.robot.told_of("stop")) > before, "STOP is sent")
    lesson.phone.wait(lambda: not lesson.phone.has("[data-action=spin_left].pending"), "the lesson is answered")
    lesson.phone.wait(lambda: not lesson.phone.has("[data-action=spin_left].saved"), "the page has gone on")
    assert not any("resume" in str(message) for message in lesson.phone.run("return window.sent;"))


def test_space_stops_while_the_slider_has_the_focus(lesson: Lesson) -> None:
    enter(lesson)
    before = len(lesson.robot.told_of("stop"))
    lesson.phone.key("keyDown", "Space")
    lesson.phone.key("keyUp", "Space")
    lesson.phone.wait(lambda: len(lesson.robot.told_of("stop")) > before, "STOP is sent")
