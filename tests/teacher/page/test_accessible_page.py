"""axe-core finds nothing on the page, and a screen reader says the question and nothing else by itself."""

from dataclasses import replace

from kurt2rt.core.teaching.progress import Progress
from kurt2rt.core.teaching.question import FeatureDifference
from tests.teacher.page.axe import violations
from tests.teacher.page.fake_robot import A_HELLO, FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LAPTOP, PORTRAIT, Phone
from tests.teacher.page.screens import LEAST_CONTRAST, TEXTS

ASKS = {
    "cause": "unknown",
    "action": None,
    "rla": None,
    "distance": 1100.0,
    "question": (FeatureDifference("s9", 441.0, 108.0), FeatureDifference("s14", 70.0, 400.0)),
}


COUNT_CHANGES = """
window.saidAgain = 0;
const all = {childList: true, subtree: true, characterData: true};
new MutationObserver(() => saidAgain++).observe(document.querySelector("#announce"), all);
"""


def prepare(robot: FakeRobot) -> None:
    actions = ("forward", "quarter_turn_left", "quarter_turn_right", "spin_left", "along_left_wall")
    robot.greeting = replace(A_HELLO, actions=actions, what="Teach it to follow the wall on its left")


def test_page_in_its_main_states_breaks_no_rule_of_axe(a_lesson: Lesson) -> None:
    phone = a_lesson.phone
    a_lesson.begin(prepare, progress=Progress(60, 87, 3), **ASKS)
    a_lesson.reads("#differences", "front left")
    assert_accessible(phone, "asks")
    a_lesson.show(cause="rla", action="forward", rla=1, question=())
    a_lesson.reads("#sentence", "RLA 1")
    phone.touch("#tab-drive")
    assert_accessible(phone, "is driven")
    phone.touch("#tab-more")
    phone.touch("#show-bubbles")
    assert_accessible(phone, "explains itself")
    phone.touch("#bubble-close")
    phone.turn(LAPTOP, touch=False)
    phone.key("keyDown", "?")
    phone.wait(lambda: phone.shows("#keys"), "the list of keys")
    assert_accessible(phone, "lists its keys")
    phone.turn(PORTRAIT)


def assert_accessible(phone: Phone, what: str) -> None:
    """Assert axe's rules, and more contrast than they want in both themes: all else is the same in the dark."""
    assert violations(phone) == [], what
    assert_readable(phone.run(TEXTS), what)
    with phone.in_the_dark():
        assert_readable(phone.run(TEXTS), f"{what}, dark")


def test_axe_sees_what_is_broken(a_lesson: Lesson) -> None:
    a_lesson.begin(prepare)
    phone = a_lesson.phone
    phone.run(
        "document.querySelector('#stop').setAttribute('aria-label', 'Halt');"
        "document.querySelector('#go').setAttribute('aria-label', ''); document.querySelector('#go').textContent = '';"
        "document.querySelector('h1').remove();"
    )
    found = violations(phone)
    phone.leave()
    assert {each.split(":")[0] for each in found} == {
        "button-name",
        "label-content-name-mismatch",
        "page-has-heading-one",
    }


def assert_readable(texts: list[tuple[str, float]], what: str) -> None:
    assert texts
    for text, contrast in texts:
        assert contrast >= LEAST_CONTRAST, f"{what}: {text!r} has a contrast of {contrast:.1f}"


def test_page_announces_each_question_once_and_nothing_else(a_lesson: Lesson) -> None:
    a_lesson.begin(prepare)
    phone = a_lesson.phone
    said = "return document.querySelector('#announce').textContent;"
    assert phone.run("return [...document.querySelectorAll('[role=status], [aria-live]')].map((e) => e.id);") == [
        "announce"
    ]
    assert phone.run(said) == ""
    a_lesson.show(**ASKS)
    phone.wait(lambda: phone.run(said) == "I don't know this situation, teach me", "the question is said")
    phone.run(COUNT_CHANGES)
    a_lesson.show(distance=1200.0, clock_s=61.0)
    a_lesson.reads("#gauge-text", "1200")
    assert phone.run("return saidAgain;") == 0
    a_lesson.show(cause="rla", action="forward", rla=1, question=(), distance=300.0)
    phone.wait(lambda: phone.run(said) == "", "it asks no more")
    a_lesson.show(**ASKS)
    phone.wait(lambda: phone.run(said) != "", "the next question is said")
