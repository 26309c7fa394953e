"""The menu of a simulated robot on the page: world, task, start again."""

from dataclasses import replace

import pytest

from kurt2rt.core.teaching.progress import Progress
from tests.teacher.page.fake_robot import A_SIMULATION, FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LANDSCAPE, LAPTOP, PORTRAIT, SMALL, Phone
from tests.teacher.page.test_browser import assert_handy

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
    lesson.reads("#said", "next_run done")
    choose(phone, "#sim-task", "wall_following")
    choose(phone, "#sim-world", "rooms")
    choose(phone, "#sim-number", "9007")
    for size in (PORTRAIT, SMALL, LANDSCAPE, LAPTOP):
        phone.turn(size)
        phone.wait(lambda: phone.run("return innerWidth") == size[0], "the screen is turned")  # noqa: B023
        phone.middle("#sim-fresh")
        assert_handy(phone, size, "more")
        phone.show(f"23-simulation-{size[0]}x{size[1]}")
    phone.turn(PORTRAIT)
    phone.touch("#sim-change")
    phone.wait(lambda: len(lesson.told("next_run")) == 2, "both were told")
    assert [each[1:] for each in lesson.robot.told if each[0] == "next_run"] == [
        (None, "eight", False),
        ("rooms-9007", None, False),
    ]


def test_back_to_start_is_one_touch_and_new_knowledge_two(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.touch("#sim-back")
    phone.wait(lambda: ("put_back",) in lesson.robot.told, "the robot is put back")
    phone.touch("#sim-fresh")
    assert "Sure?" in phone.text("#sim-fresh")
    assert not lesson.told("next_run")
    phone.touch("#sim-fresh")
    phone.wait(lambda: ("next_run", None, None, True) in lesson.robot.told, "the next run is wanted")


def test_speed_is_chosen_and_the_reached_one_shown(lesson: Lesson) -> None:
    phone, robot = lesson.phone, lesson.robot
    robot.simulated = replace(A_SIMULATION, speed=10, reached=5.04)
    choose(phone, "#sim-speed", "10")
    phone.wait(lambda: ("set_speed", 10) in robot.told, "it is told")
    lesson.reads("#sim-reached", "5.0 times reached")
    choose(phone, "#sim-task", "eight")
    robot.simulated = replace(A_SIMULATION, speed=10, reached=7.3)
    assert robot.state is not None
    lesson.show(tick=robot.state.tick + 100)
    lesson.reads("#sim-reached", "7.3 times reached")
    assert phone.run("return document.querySelector('#sim-task').value;") == "eight"
    phone.middle("#sim-speed")
    phone.show("25-speed")


@pytest.mark.parametrize(("unit", "shown"), [("laps", "laps 2.3"), ("m", "distance 2 m")])
def test_progress_shows_the_task_s_unit(a_lesson: Lesson, unit: str, shown: str) -> None:
    def prepare(robot: FakeRobot) -> None:
        robot.simulated = replace(A_SIMULATION, progress=2.34, unit=unit)

    a_lesson.begin(prepare, progress=Progress(60, 87, 3), rlas=12)
    a_lesson.reads("#progress", f"by itself 87 % · asks 3 a minute · rules 12 · {shown}")
    a_lesson.phone.show(f"26-measure-{unit}")


def test_generated_world_is_chosen_by_its_number(a_lesson: Lesson) -> None:
    def prepare(robot: FakeRobot) -> None:
        robot.simulated = replace(A_SIMULATION, world="rooms-17")

    a_lesson.begin(prepare)
    phone = a_lesson.phone
    phone.touch("#tab-more")
    values = "return ['#sim-world', '#sim-number'].map((each) => document.querySelector(each).value);"
    phone.wait(lambda: phone.run(values) == ["rooms", "17"], "it shows the world")
    choose(phone, "#sim-number", "-3")
    assert phone.run("return document.querySelector('#sim-change').disabled;")


def test_a_real_robot_has_no_simulation(a_lesson: Lesson) -> None:
    def prepare(robot: FakeRobot) -> None:
        robot.greeting = replace(robot.greeting, simulated=False)

    a_lesson.begin(prepare, place=None)
    a_lesson.phone.touch("#tab-more")
    assert a_lesson.phone.shows("#export")
    assert not a_lesson.phone.shows("#simulation")
