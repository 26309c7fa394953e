"""The inner critic on the page: a teacher teaches it in phase 4, and watches it in phase 5."""

import re
from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.hello import AppraisalName
from tests.teacher.page.fake_robot import A_HELLO, A_LESSON, FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.screens import on_each_screen

ACTIONS = (
    *("forward", "back", "stand", "bear_left", "bear_right", "curve_left", "curve_right", "spin_left", "spin_right"),
    *("quarter_turn_left", "quarter_turn_right", "along_left_wall", "along_right_wall"),
    *("sharp_left", "sharp_right", "flee", "whirl_left", "whirl_right"),
)
APPRAISALS = (AppraisalName("good", 1), AppraisalName("bad", -1), AppraisalName("neutral", 0))


def fits(lesson: Lesson) -> None:
    """Nothing of the critic's words runs out of their box."""
    over = lesson.phone.run(
        "const edge = document.querySelector('#critic').getBoundingClientRect().right;"
        "return [...document.querySelectorAll('#critic *')].filter((e) => e.checkVisibility())"
        ".filter((e) => e.getBoundingClientRect().right > edge).map((e) => e.textContent);"
    )
    assert over == []


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    def prepare(robot: FakeRobot) -> None:
        robot.greeting = replace(A_HELLO, actions=ACTIONS, appraisals=APPRAISALS, trusted_from=0.8)
        robot.newest_lessons = (A_LESSON,)

    a_lesson.begin(prepare, phase=4, opinion=1, opinion_of=40, signals_missing=(6, 2))
    return a_lesson


def test_phase_4_rewards_teach_the_critic_and_show_agreement(lesson: Lesson) -> None:
    phone = lesson.phone
    lesson.reads("#opinion", "critic: thinks good")
    assert phone.text("#trusted").startswith("not ")
    assert re.findall(r"\d", phone.text("#agreement-text")) == ["6", "2"]
    fits(lesson)
    shown = phone.texts("#rewards button")
    assert [each.split()[-1] for each in shown] == ["bad", "neutral", "good", "last", "rewind"]
    phone.touch("[data-appraisal=bad]")
    lesson.reads("#said", "appraise done")
    phone.key("keyDown", "0")
    phone.wait(lambda: lesson.told("/appraise") == ["bad", "neutral"], "a key teaches it, too")
    assert lesson.told("/reward") == []

    lesson.show(opinion=None, opinion_of=None, agreement=0.61, signals_missing=(0, 0))
    lesson.reads("#opinion", "critic: does not know this")
    lesson.reads("#agreement-text", "agrees 0.61, needs 0.80")
    fits(lesson)
    lesson.show(opinion=-1, opinion_of=41, agreement=0.87, trusted=True)
    lesson.reads("#agreement-text", "0.87")
    assert phone.text("#trusted") == "trusted"
    lesson.reads("#opinion", "critic: thinks bad")
    assert not phone.shows("#role")
    assert not phone.shows("#changed")
    on_each_screen(phone, "11-phase-4", lambda: fits(lesson))

    lesson.show(phase=3, value=-0.001)
    phone.wait(lambda: not phone.shows("#critic"), "it is hidden before phase 4")
    lesson.reads("#gauge-text", "value 0.00")
    lesson.show(value=-0.08)
    lesson.reads("#gauge-text", "value \N{MINUS SIGN}0.08")
    phone.touch("#blame")
    phone.wait(lambda: lesson.told("/reward") == [-1], "a signal is the robot's reward again")
