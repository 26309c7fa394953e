"""Undo on the page: the first touch names the lesson, and whether the last press gave one."""

from kurt2rt.channel.protocol.lesson_list import Contradicting
from kurt2rt.core.decision.standing import Standing
from tests.teacher.page.fake_robot import A_LESSON, FakeRobot
from tests.teacher.page.lesson import Lesson


def with_a_lesson(robot: FakeRobot) -> None:
    robot.newest_lessons = (A_LESSON,)


def test_first_touch_tells_a_press_that_taught_nothing(a_lesson: Lesson) -> None:
    a_lesson.begin(with_a_lesson, standing=Standing())
    a_lesson.phone.touch("[data-action=spin_left]")
    a_lesson.phone.wait(lambda: a_lesson.phone.has("#said.saved"), "the press is answered")
    a_lesson.phone.touch("#undo-last")
    a_lesson.phone.wait(lambda: a_lesson.phone.has("#said.asks"), "the page asks for another touch")
    assert "taught nothing" in a_lesson.phone.text("#said")
    a_lesson.phone.touch("#undo-last")
    a_lesson.phone.wait(lambda: a_lesson.told("/undo") == [A_LESSON.command_id], "the named lesson is undone")


def test_lesson_that_contradicts_is_shown_and_undone_alone(a_lesson: Lesson) -> None:
    slip = Contradicting("local-hold-1/95", 7, "whirl_left", 4, ("forward", "bear_left"))
    hold = A_LESSON._replace(command_id="local-hold-1", text="held forward, whirl_left: 2 lessons", against=(slip,))

    def with_a_slip(robot: FakeRobot) -> None:
        robot.newest_lessons = (hold,)

    a_lesson.begin(with_a_slip, standing=Standing())
    a_lesson.phone.touch("#tab-lessons")
    a_lesson.reads("#lesson-list .contradicts", "RLA 7 says whirl left")
    assert all(word in a_lesson.phone.text("#lesson-list .contradicts") for word in ("forward, bear left", "RLA 4"))
    a_lesson.phone.show("a-slip")
    a_lesson.phone.touch("#lesson-list .contradicts button")
    a_lesson.phone.touch("#lesson-list .contradicts button")
    a_lesson.phone.wait(lambda: a_lesson.told("/undo") == [slip.command_id], "the one lesson is undone")
    a_lesson.phone.touch("#tab-teach")
