"""A teacher who has never seen the page: the first lesson, and the three bubbles."""

from tests.teacher.page.lesson import Lesson

BUBBLES = 3
STORED = "return localStorage.getItem('kurt2rt.bubbles');"


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
