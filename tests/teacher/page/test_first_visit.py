"""A teacher who has never seen the page: the first lesson, and the three bubbles."""

from pathlib import Path

from tests.teacher.page.classroom import classroom
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import PORTRAIT, Phone

BUBBLES = 3
COVERED = """
const cover = document.querySelector("#bubble").getBoundingClientRect();
const covered = (box) =>
  box.left < cover.right && cover.left < box.right && box.top < cover.bottom && cover.top < box.bottom;
return [...document.querySelectorAll("#done button")]
  .filter((each) => each.checkVisibility() && covered(each.getBoundingClientRect()))
  .map((each) => each.id || each.textContent);
"""
STORED = "return localStorage.getItem('kurt2rt.bubbles');"


def test_first_lesson_of_a_fresh_start_takes_two_taps(a_phone: Phone, tmp_path: Path) -> None:
    phone = a_phone
    with classroom(tmp_path, phone) as room, phone.first_visit():
        phone.open(room.address)
        phone.wait(lambda: phone.text("#what") == "Teach it to follow the wall on its left", "what the task is")
        phone.wait(lambda: phone.shows("#claim-button"), "the robot can be taken")
        assert phone.shows("#bubble")  # it covers neither of the two buttons
        phone.touch("#claim-button")
        phone.wait(lambda: phone.run("return !document.querySelector('#teach').inert;"), "this page has control")
        phone.touch("[data-action=along_left_wall]")
        phone.wait(lambda: room.state().lessons == 1, "a lesson, after two taps")
        phone.wait(lambda: phone.text("#lesson-count") == "1", "the page shows it")


def test_bubbles_say_what_to_do_once_and_come_back_by_the_button(a_lesson: Lesson) -> None:
    phone = a_lesson.phone
    with phone.first_visit():
        phone.forget()
        a_lesson.begin()
        told = []
        for number in range(1, BUBBLES + 1):
            assert phone.text("#bubble-number") == f"{number} of {BUBBLES}"
            told.append(phone.text("#bubble-text"))
            assert len(phone.run("return [...document.querySelectorAll('.pointed-at')];")) == 1
            assert phone.run(STORED) is None
            phone.touch("#bubble-next")
        assert len(set(told)) == BUBBLES
        assert not phone.shows("#bubble")
        assert phone.run(STORED) == "seen"
        phone.leave()
        a_lesson.begin()
        assert not phone.shows("#bubble")
        phone.touch("#show-bubbles")
        assert phone.text("#bubble-text") == told[0]
        phone.touch("#bubble-close")
        assert not phone.shows("#bubble")
        assert not phone.has(".pointed-at")


def test_bubble_leaves_all_buttons_of_the_panel_free(a_lesson: Lesson) -> None:
    a_lesson.begin()
    phone = a_lesson.phone
    phone.touch("#show-bubbles")
    for size in (PORTRAIT, (360, 600), (844, 390), (1280, 800)):
        phone.turn(size)
        phone.wait(lambda: phone.run("return innerWidth") == size[0], "the screen is turned")  # noqa: B023 - called at once
        hidden = phone.run(COVERED)
        assert hidden == [], size
    phone.touch("#bubble-close")
