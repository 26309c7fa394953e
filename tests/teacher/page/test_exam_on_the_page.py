"""The exam, begun and shown on the page of a simulated robot."""

import io

import pytest
from matplotlib.figure import Figure

from kurt2rt.channel.protocol.exam_status import ExamStatus, WorldVerdict
from tests.teacher.page.axe import violations
from tests.teacher.page.fake_robot import FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.screens import on_each_screen

DRIVES = ExamStatus(True, 0.42, "exam without teacher, world b")
VERDICTS = (
    WorldVerdict("A", True, "4.86 of the teacher's 5.00 laps, no collision"),
    WorldVerdict("B", False, "1.02 of the teacher's 3.58 laps, 2 collisions, stuck after 113 s"),
    WorldVerdict("cave", False, "not judged: the policy itself gets nowhere here (0.02 laps)", judged=False),
)
OVER = ExamStatus(False, 1.0, "Passed in 1 of 2 worlds; 1 not judged.", VERDICTS, "wall-following-20261122T180000.png")
LOADED = "const e = document.querySelector('#exam-picture'); return e.complete && e.naturalWidth;"


def picture() -> bytes:
    content = io.BytesIO()
    Figure(figsize=(2.0, 2.0)).savefig(content, format="png")
    return content.getvalue()


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    def prepare(robot: FakeRobot) -> None:
        robot.files[OVER.picture] = picture()

    a_lesson.begin(prepare)
    return a_lesson


def later(lesson: Lesson, standing: ExamStatus) -> None:
    """Half a second of the robot later the exam stands so."""
    state = lesson.robot.state
    assert state is not None
    lesson.robot.examined = standing
    lesson.show(tick=state.tick + 50)


def test_an_exam_ends_in_a_picture_and_a_verdict(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.touch("#tab-more")
    lesson.robot.examined = DRIVES
    phone.touch("#examine")
    lesson.reads("#exam-says", "42 %: exam without teacher, world b")
    assert ("/exam",) in lesson.robot.told
    assert phone.run("return document.querySelector('#examine').disabled;")
    phone.show("21-exam-runs")
    later(lesson, OVER)
    lesson.reads("#exam-verdict", "Passed in 1 of 2 worlds; 1 not judged.")
    lesson.reads("#exam-worlds", "World B: failed")
    lesson.reads("#exam-worlds", "World cave: not judged")
    phone.wait(lambda: phone.run(LOADED), "the picture is there")
    assert violations(phone) == []
    on_each_screen(phone, "22-exam")
    phone.touch("#close-exam")
    assert not phone.shows("#exam-result")
    phone.touch("#show-exam")
    assert phone.shows("#exam-result")
