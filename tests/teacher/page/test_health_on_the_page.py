"""Health of the robot on the page: the line in the bar, the table, the warnings."""

from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.health import HealthReport
from tests.service.health.reports import ILL, SILENT, WELL
from tests.teacher.page.fake_robot import FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import PORTRAIT, SMALL
from tests.teacher.page.screens import on_each_screen

CLASS = "return document.querySelector(arguments[0]).className;"


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    def prepare(robot: FakeRobot) -> None:
        robot.report = replace(WELL, tick=100)

    a_lesson.begin(prepare)
    return a_lesson


def later(lesson: Lesson, ticks: int, report: HealthReport) -> None:
    """So many ticks later the robot makes a report."""
    state = lesson.robot.state
    assert state is not None
    lesson.robot.report = replace(report, tick=state.tick + ticks)
    lesson.show(tick=state.tick + ticks)


def falls_ill(lesson: Lesson) -> None:
    """Send the report of a second later."""
    later(lesson, 100, ILL)


def test_on_a_phone_the_line_shows_all_of_it(lesson: Lesson) -> None:
    phone = lesson.phone
    lesson.show(late_p99_ms=12.3, missed_ticks=123, lessons=123, clock_s=3671.0)
    for size in (PORTRAIT, SMALL):
        phone.turn(size)
        lesson.reads("#health", "late 12.3 ms" if size == SMALL else "late 12.3 ms, missed 123")
        phone.show(f"12-line-{size[0]}x{size[1]}")
        cut = phone.run("const e = document.querySelector('#health'); return e.scrollWidth - e.clientWidth;")
        assert cut <= 0, size
    phone.turn(PORTRAIT)


def test_a_touch_on_the_bar_opens_a_table_of_how_the_robot_is(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.wait(lambda: phone.text("#health") == "late 0.20 ms, missed 0", "all is well")
    assert not phone.shows("#health-table")
    phone.touch("#link")
    lesson.reads("#health-says", "well; late 0.31 ms (p99), missed 0")
    rows = phone.text("#health-rows")
    for words in ("forward by RLA 12", "range sensors 4 ms old", "knowledge: 79.9 GB free", "battery 83%, discharging"):
        assert words in rows
    phone.touch("#stop")  # which is never covered
    phone.wait(lambda: lesson.robot.told.count(("stop",)) == 1, "the robot is stopped")
    phone.touch("#close-health")
    assert not phone.shows("#health-table")


def test_faults_are_coloured_with_time_and_cure(lesson: Lesson) -> None:
    phone = lesson.phone
    falls_ill(lesson)
    lesson.reads("#health", "sensors silent, …")
    assert phone.run(CLASS, "#health") == "warns urgent"
    lesson.reads("#warnings", SILENT.what)
    phone.touch("#link")
    lesson.reads("#health-says", "sensors silent (urgent), ticks missed; late 2.90 ms (p99), missed 7")
    lesson.reads("#health-troubles", f"{SILENT.what} (for 2 s): {SILENT.to_do}")
    lesson.reads("#health-troubles", "3 ticks missed in the last minute, 7 in all (for 3 min 5 s)")
    on_each_screen(phone, "12-health")
    phone.touch("#close-health")
    assert not phone.shows("#health-table")
