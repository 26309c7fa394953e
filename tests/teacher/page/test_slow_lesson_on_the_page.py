"""Slow lessons on the page: the speed is set in More and shown in place of the phase's name."""

from kurt2rt.core.decision.standing import Standing
from tests.teacher.page.lesson import Lesson

_CHOOSE = """
const speed = document.querySelector('#lesson-speed');
speed.value = arguments[0];
speed.dispatchEvent(new Event('input'));
"""
_CHOSEN = "return document.querySelector('#lesson-speed').value;"


def test_chosen_lesson_speed_is_shown_in_place_of_the_phase(a_lesson: Lesson) -> None:
    a_lesson.begin(standing=Standing(), phase=2)
    a_lesson.phone.touch("#tab-more")
    assert a_lesson.phone.run(_CHOSEN) == "100"
    a_lesson.phone.run(_CHOOSE, "60")
    a_lesson.phone.wait(lambda: a_lesson.told("/lesson/speed") == [60], "the robot is told")
    a_lesson.show(lesson_speed=0.35)
    a_lesson.reads("#phase-name", "slow, 35 %")
    a_lesson.phone.wait(lambda: a_lesson.phone.run(_CHOSEN) == "35", "a speed between those of the list is shown")
