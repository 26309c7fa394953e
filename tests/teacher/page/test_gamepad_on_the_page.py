"""A gamepad drives while its shoulder button is held, and only then."""

from collections.abc import Iterator

import pytest

from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import Phone

# One pad of the standard mapping, as the browser would tell of it.
PAD = """
window.pad = {index: 0, id: "pad", connected: true, mapping: "standard", axes: [0, 0, 0, 0], timestamp: 0,
  buttons: Array.from({length: 17}, () => ({pressed: false, touched: false, value: 0}))};
window.pads = [null];
window.away = false;
navigator.getGamepads = () => pads;
window.tellPad = (kind) => {
  const event = new Event(kind);
  event.gamepad = pad;
  dispatchEvent(event);
};
window.shoulder = (held) => { pad.buttons[5] = {pressed: held, touched: held, value: Number(held)}; };
document.hasFocus = () => !window.away;
"""


UNPLUG = "pads[0] = null; delete document.visibilityState; tellPad('gamepaddisconnected');"


@pytest.fixture
def driving(a_lesson: Lesson) -> Iterator[Lesson]:
    """Return a page with a new gamepad, whose buttons the page has seen released.

    The page stays loaded between tests: loading it takes most of a test's time.
    """
    phone = a_lesson.phone
    a_lesson.begin()
    phone.run(PAD)
    phone.run("pads[0] = pad; tellPad('gamepadconnected');")
    a_lesson.reads("#said", "gamepad: hold a shoulder button")
    polled(phone)
    yield a_lesson
    phone.run(UNPLUG)
    phone.wait(lambda: not a_lesson.robot.pressing, "it lets go of the robot of this test")


def presses(lesson: Lesson) -> list[tuple[object, ...]]:
    return [each for each in lesson.robot.told if each[0] == "press"]


def polled(phone: Phone) -> None:
    """Wait for a few polls of the gamepad."""
    phone.pass_time(0.2)


def hold(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.run("shoulder(false)")
    polled(phone)
    phone.run("pad.axes = [0, -1, 0, 0]; shoulder(true)")
    phone.wait(lambda: lesson.robot.pressing and phone.has("#stick.held"), "the pad drives")


def test_gamepad_drives_while_its_shoulder_button_is_held(driving: Lesson) -> None:
    driving.phone.run("pad.axes = [0, -1, 0, 0]")
    polled(driving.phone)
    assert presses(driving) == [], "the stick alone drives nothing"
    hold(driving)
    assert presses(driving)[-1] == ("press", 0.3, 0.3)
    driving.phone.run("pad.axes = [1, 0.05, 0, 0]")
    driving.phone.wait(lambda: presses(driving)[-1][1:] == (0.18, -0.18), "it turns right; nearly nothing is nothing")
    driving.phone.run("shoulder(false)")
    driving.phone.wait(lambda: not driving.robot.pressing, "it lets go")
    count = len(presses(driving))
    polled(driving.phone)
    assert len(presses(driving)) == count


@pytest.mark.parametrize(
    "end",
    [
        "pad.connected = false; pads[0] = null; tellPad('gamepaddisconnected')",
        pytest.param("pads[0] = null", marks=pytest.mark.deep),
        pytest.param("window.away = true; dispatchEvent(new Event('blur'))", marks=pytest.mark.deep),
        "Object.defineProperty(document, 'visibilityState', {value: 'hidden', configurable: true});"
        "document.dispatchEvent(new Event('visibilitychange'))",
        pytest.param("document.querySelector('#stop').click()", marks=pytest.mark.deep),
    ],
    ids=["disconnected", "gone", "blur", "hidden", "stop"],
)
def test_gamepad_lets_go_for_good_until_pressed_again(driving: Lesson, end: str) -> None:
    hold(driving)
    phone = driving.phone
    phone.run(end)
    phone.wait(lambda: not driving.robot.pressing, "it lets go")
    # The button is still held when all is well again: that is no new press.
    phone.run(
        "window.away = false; pad.connected = true; delete document.visibilityState; pads[0] = pad;"
        "tellPad('gamepadconnected');"
    )
    count = len(presses(driving))
    polled(phone)
    assert len(presses(driving)) == count
    hold(driving)


def test_gamepad_of_a_page_that_only_watches_drives_nothing(driving: Lesson) -> None:
    driving.show(teacher="ann")
    driving.phone.wait(lambda: driving.phone.shows("#claim"), "another one teaches")
    driving.phone.run("pad.axes = [0, -1, 0, 0]; shoulder(true)")
    polled(driving.phone)
    driving.show(teacher="local")
    driving.phone.wait(lambda: not driving.phone.shows("#claim"), "this page's teacher again")
    polled(driving.phone)
    assert presses(driving) == []  # it was held before


CROSS_UP = "pad.buttons[12] = {pressed: %s, touched: false, value: 0}"


def test_gamepad_hold_ended_by_the_page_needs_a_new_press(driving: Lesson) -> None:
    phone = driving.phone
    phone.run(CROSS_UP % "true")
    phone.wait(lambda: driving.told("hold"), "the action is held")
    phone.run("dispatchEvent(new Event('blur'))")
    phone.wait(lambda: driving.robot.told_of("let_go"), "it is released")
    count = len(driving.told("hold"))
    polled(phone)
    assert len(driving.told("hold")) == count
