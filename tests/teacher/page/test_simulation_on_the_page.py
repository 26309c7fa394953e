"""The menu of a simulated robot on the page: world, task, start again."""

import pytest

from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import Phone
from tests.teacher.page.screens import on_each_screen

CHOOSE = """
const e = document.querySelector(arguments[0]);
e.value = arguments[1];
e.dispatchEvent(new Event("input"));
"""


def choose(phone: Phone, selector: str, value: str) -> None:
    phone.run(CHOOSE, selector, value)


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    a_lesson.begin(lambda _: None)
    phone = a_lesson.phone
    phone.touch("#tab-more")
    phone.wait(lambda: phone.run("return document.querySelector('#sim-task').value;"), "it knows what is simulated")
    return a_lesson


def test_another_world_and_task_are_two_choices_and_a_touch(lesson: Lesson) -> None:
    phone = lesson.phone
    assert phone.run("return document.querySelector('#sim-change').disabled;")
    choose(phone, "#sim-task", "eight")
    lesson.reads("#sim-what", "Teach it to drive an eight round the two columns")
    phone.touch("#sim-change")
    lesson.reads("#said", "/simulation/run done")
    choose(phone, "#sim-task", "wall_following")
    choose(phone, "#sim-world", "rooms")
    choose(phone, "#sim-number", "9007")
    on_each_screen(phone, "23-simulation")
    phone.touch("#sim-change")
    phone.wait(lambda: len(lesson.told("/simulation/run")) == 2, "both were told")
    assert [each[1:] for each in lesson.robot.told if each[0] == "/simulation/run"] == [
        (None, "eight", False),
        ("rooms-9007", None, False),
    ]


def test_back_to_start_is_one_touch_and_new_knowledge_two(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.touch("#sim-back")
    phone.wait(lambda: ("/world/start",) in lesson.robot.told, "the robot is put back")
    phone.touch("#sim-fresh")
    assert "Sure?" in phone.text("#sim-fresh")
    assert not lesson.told("/simulation/run")
    phone.touch("#sim-fresh")
    phone.wait(lambda: ("/simulation/run", None, None, True) in lesson.robot.told, "the next run is wanted")
