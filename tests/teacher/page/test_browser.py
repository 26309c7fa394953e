"""The page in a real browser, with the real client and a simulated robot: what a teacher with a phone lives through."""

import itertools
from dataclasses import replace

import pytest

from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from tests.teacher.page.classroom import Classroom
from tests.teacher.page.fake_robot import A_HELLO, FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LANDSCAPE, LAPTOP, PORTRAIT, SMALL, Phone

ACTIONS = ("along_left_wall", "forward", "curve_right", "spin_right", "bear_left")
TABS = ("teach", "drive", "lessons", "more")
LEAST_TARGET_PX = 48
LEAST_CONTRAST = 7.0

TEXTS = """
const luminance = (rgb) => {
  const [r, g, b] = rgb.map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const colour = (text) => text.match(/[\\d.]+/g).map(Number);
const ground = (e) => {
  for (; e; e = e.parentElement) {
    const [r, g, b, a] = colour(getComputedStyle(e).backgroundColor);
    if (a === undefined || a > 0.8) return [r, g, b];
  }
  return [255, 255, 255];
};
return [...document.querySelectorAll("body *")]
  .filter((e) => e.checkVisibility() && [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim()))
  .map((e) => {
    const [a, b] = [luminance(colour(getComputedStyle(e).color).slice(0, 3)), luminance(ground(e))];
    return [e.textContent.trim().slice(0, 30), (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05)];
  });
"""
TARGETS = """
return [...document.querySelectorAll("button, input, #stick")].filter((e) => e.checkVisibility()).map((e) => {
  const b = e.getBoundingClientRect();
  return [e.id || e.textContent.trim(), b.width, b.height, b.left, b.right];
});
"""


def lessons_shown(phone: Phone) -> int:
    return int(phone.text("#lesson-count"))


def no_picture(phone: Phone) -> bool:
    return phone.shows("#no-picture")


def said(phone: Phone) -> str:
    phone.wait(lambda: not phone.has("#said.pending"), "an answer")
    assert phone.has("#said.saved"), phone.text("#said")
    return phone.text("#said")


def begin(phone: Phone, room: Classroom) -> None:
    """Open the page and be the teacher."""
    phone.time = room.time
    room.mend()
    phone.turn(PORTRAIT)
    phone.come_to(room.address)
    phone.wait(lambda: not no_picture(phone), "a picture")
    phone.wait(lambda: phone.text("#sentence"), "it knows which robot this is, and says what it does")
    phone.wait(lambda: phone.run("return innerWidth") == PORTRAIT[0], "the screen is turned")
    if phone.shows("#claim"):
        phone.touch("#claim-button")
    phone.wait(lambda: not phone.shows("#claim"), "this page has control")
    room.put_robot_in_the_open()


def hold_stick(phone: Phone) -> None:
    """Put a finger on the circle and push it forward."""
    phone.touch("#tab-drive")
    x, y = phone.middle("#stick")
    phone.finger_down(x, y)
    phone.finger_to(x, y - 60)


def test_a_teacher_teaches_drives_loses_the_link_and_comes_back(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone

    # The code of the pairing opens the page; the robot shows itself and knows nothing.
    phone.open(room.address)
    phone.wait(lambda: phone.text("#sentence") == "I know nothing yet, teach me", "the robot asks")
    phone.show("1-no teacher-teaches")
    phone.touch("#claim-button")
    phone.wait(lambda: room.state().teacher == "local", "this device teaches")
    phone.wait(lambda: not phone.shows("#claim"), "this page has control")
    phone.show("2-it-asks")

    # Ten lessons by touching actions: answers while it asks, corrections while it drives.
    for action in itertools.cycle(ACTIONS):
        phone.wait(lambda: not phone.has("#actions[aria-busy=true]"), "it may be taught again")
        before = lessons_shown(phone)
        phone.touch(f"[data-action={action}]")
        if "says" in said(phone):
            continue  # it knew that already
        phone.wait(lambda: lessons_shown(phone) == before + 1, "one lesson more")  # noqa: B023 - called at once
        if before == 0:
            phone.wait(lambda: phone.text("#sentence").startswith("RLA 1 does along left wall"), "the lesson acts")
            phone.show("3-it-drives")
        if before == 9:
            break
    assert room.state().lessons == 10

    # The last one is taken back, with a second touch to be sure; a list that comes too late would refuse it.
    listed = "return document.querySelectorAll('#lesson-list li').length"
    phone.wait(lambda: phone.run(listed) >= 10, "the page's list has them all")
    phone.touch("#undo-last")
    assert phone.text("#undo-last .word") == "sure?"
    assert room.state().lessons == 10
    phone.touch("#undo-last")
    phone.wait(lambda: room.state().lessons == 9, "the lesson is undone")
    assert said(phone).startswith("undone")
    phone.touch("#tab-lessons")
    phone.wait(lambda: "undone" in phone.text("#lesson-list li"), "the list says so")
    phone.show("4-lessons")

    # A finger on the circle drives the robot; lifted, it stands until GO.
    room.put_robot_in_the_open()
    hold_stick(phone)
    phone.wait(lambda: room.state().by_hand and room.state().left_m_s > 0.05, "the robot drives by hand")
    phone.wait(lambda: phone.text("#sentence") == "local drives by hand", "the page says who drives")
    phone.show("5-by-hand")
    phone.finger_up()
    phone.wait(lambda: not room.state().by_hand and room.state().left_m_s == 0, "the robot stands")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")
    phone.show("6-let-go")

    # The link breaks while the circle is held: no picture, and the press is over for good.
    hold_stick(phone)
    phone.wait(lambda: room.state().by_hand, "the robot drives by hand")
    room.cut()
    phone.wait(lambda: no_picture(phone), "the page says that it sees nothing")
    phone.wait(lambda: not phone.has("#stick.held"), "the circle lets go")
    assert phone.has("#go:disabled")
    assert phone.has("#stop:enabled")
    phone.show("7-no-picture")
    room.mend()
    phone.wait(lambda: not no_picture(phone), "the picture is back")
    back = room.state().tick
    phone.wait(lambda: room.state().tick > back + 30, "some more pictures")
    assert not room.state().by_hand  # though the finger is still there
    phone.finger_up()

    # STOP, and GO again.
    phone.touch("#stop")
    phone.wait(lambda: room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local"), "the robot was stopped")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")
    phone.touch("#go")
    phone.wait(lambda: room.state().stopped is None, "the robot may drive")
    assert phone.complaints() == []


def test_a_page_whose_scripts_stand_still_lets_go_of_the_robot(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    hold_stick(phone)
    phone.wait(lambda: room.state().by_hand, "the robot drives by hand")
    room.time.pass_server_time(1.0)
    assert not room.state().by_hand
    assert room.state().left_m_s == 0
    phone.wait(lambda: not phone.has("#stick.held"), "the circle lets go")
    phone.finger_up()


def test_a_page_that_is_left_lets_go_of_the_robot(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    hold_stick(phone)
    phone.wait(lambda: room.state().by_hand, "the robot drives by hand")
    phone.open("about:blank")
    phone.wait(lambda: not room.state().by_hand and room.state().left_m_s == 0, "the robot stands")
    phone.finger_up()


def test_the_keyboard_of_a_laptop_drives_and_stops(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    phone.turn(LAPTOP, touch=False)
    phone.key("keyDown", "KeyW")
    phone.wait(lambda: room.state().by_hand and room.state().left_m_s > 0.05, "the robot drives by hand")
    phone.key("keyUp", "KeyW")
    phone.wait(lambda: not room.state().by_hand, "the robot stands")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")
    phone.key("keyDown", "Enter")
    phone.wait(lambda: room.state().stopped is None, "the robot may drive")
    phone.key("keyDown", "Space")
    phone.wait(lambda: room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local"), "the robot was stopped")


def stand(phone: Phone, room: Classroom) -> None:
    """Stop the robot, and let it drive again: whatever a key does after it is seen."""
    phone.touch("#stop")
    phone.wait(lambda: "stands until" in phone.text("#said"), "the robot answers")
    after = room.state().tick
    phone.wait(lambda: room.state().tick > after + 20, "pictures from after it")
    assert room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")


def test_enter_belongs_to_the_button_that_has_the_focus(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    stand(phone, room)
    phone.turn(LAPTOP, touch=False)
    phone.run("document.querySelector('#show-keys').focus()")
    phone.key("keyDown", "Enter")
    phone.wait(lambda: phone.shows("#keys"), "the list of keys opens")
    phone.key("keyDown", "Enter")  # its button has the focus
    phone.wait(lambda: not phone.shows("#keys"), "the list of keys closes")
    assert room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local")
    phone.run("document.activeElement.blur()")
    phone.key("keyDown", "Enter")
    phone.wait(lambda: room.state().stopped is None, "the robot may drive")
    phone.run("document.querySelector('#stop').focus()")
    phone.key("keyDown", "Enter")
    phone.wait(lambda: room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local"), "the robot was stopped")


@pytest.mark.deep
@pytest.mark.parametrize("size", [PORTRAIT, SMALL, LANDSCAPE, LAPTOP], ids=["portrait", "small", "landscape", "laptop"])
def test_the_list_of_keys_leaves_stop_and_go_free(a_phone: Phone, room: Classroom, size: tuple[int, int]) -> None:
    phone = a_phone
    begin(phone, room)
    phone.turn(size, touch=size != LAPTOP)
    phone.key("keyDown", "?")
    phone.wait(lambda: phone.shows("#keys"), "the list of keys opens")
    phone.show(f"10-{size[0]}x{size[1]}-keys")
    stand(phone, room)
    phone.touch("#go")
    phone.wait(lambda: room.state().stopped is None, "the robot may drive")
    phone.key("keyDown", "Space")
    phone.wait(lambda: room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local"), "the robot was stopped")
    assert phone.shows("#keys")
    phone.key("keyDown", "?")
    phone.wait(lambda: not phone.shows("#keys"), "the list of keys closes")


@pytest.mark.parametrize(
    "swallowed",
    [
        "dispatchEvent(new KeyboardEvent('keydown', {key: 'Meta', code: 'MetaLeft', metaKey: true}))",
        "document.querySelector('#stage').dispatchEvent(new MouseEvent('contextmenu', {bubbles: true}))",
    ],
    ids=["command", "menu"],
)
def test_a_key_whose_end_the_browser_keeps_to_itself_lets_go(a_phone: Phone, room: Classroom, swallowed: str) -> None:
    phone = a_phone
    begin(phone, room)
    phone.turn(LAPTOP, touch=False)
    phone.key("keyDown", "KeyW")
    phone.wait(lambda: room.state().by_hand, "the robot drives by hand")
    phone.run(swallowed)
    phone.wait(lambda: not room.state().by_hand, "the robot stands")
    phone.key("keyUp", "KeyW")


def test_arrow_keys_steer_after_a_click_of_the_tab(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    phone.touch("#tab-drive")
    phone.key("keyDown", "ArrowLeft")
    phone.wait(lambda: room.state().by_hand, "the robot drives by hand")
    assert phone.shows("#drive")
    phone.key("keyUp", "ArrowLeft")
    phone.key("keyDown", "KeyU")
    phone.touch("#tab-teach")
    assert phone.text("#undo-last .word") == "undo"
    phone.key("keyDown", "KeyU")
    assert phone.text("#undo-last .word") == "sure?"


def test_two_quick_touches_while_it_asks_are_one_lesson(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    for _ in range(room.state().lessons):
        assert room.time.pass_until(room.client.undo).accepted
    phone.wait(lambda: lessons_shown(phone) == 0, "the page knows")
    stand(phone, room)
    phone.touch("#go")
    phone.wait(lambda: "nothing yet" in phone.text("#sentence"), "the robot asks")
    text = phone.run(
        "for (const a of ['forward', 'curve_right']) document.querySelector(`[data-action=${a}]`).click();"
        "return document.querySelector('#said').textContent;"
    )
    assert "curve right" in text
    phone.wait(lambda: lessons_shown(phone) == 1, "one lesson")
    phone.wait(lambda: phone.has("#actions[aria-busy=false]"), "it may be taught again")
    assert room.state().rlas == 1


SHUTTER = """
window.sockets = [];
window.shut = false;
const Open = WebSocket;
WebSocket = class extends Open {
  constructor(place) {
    super(shut ? new URL("/nothing", place) : place);
    sockets.push(this);
  }
};
"""


def test_a_stop_without_a_link_is_sent_when_the_link_is_back(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    with phone.before_scripts(SHUTTER):
        phone.open(room.address)
    begin(phone, room)
    phone.run("sockets.at(-1).close(); shut = true")
    phone.wait(lambda: no_picture(phone), "the page sees nothing")
    phone.wait(lambda: not room.client.watching, "its server knows that no teacher looks")
    # A page that went may have left a stop on its way, also behind the first resume.
    resumed = room.client.resume
    phone.wait(lambda: room.time.pass_until(resumed).accepted and room.state().stopped is None, "the robot may drive")
    phone.touch("#stop")
    phone.wait(lambda: "no link" in phone.text("#said"), "the page says that STOP waits")
    assert phone.text("#stop") == "STOP …"
    phone.run("shut = false")
    phone.wait(lambda: room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local"), "the robot was stopped")
    phone.wait(lambda: phone.text("#stop") == "STOP", "STOP was answered")


def test_a_hand_puts_the_robot_elsewhere_in_the_simulated_world(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    stand(phone, room)  # a place given before the page knows of the stop would be refused
    phone.wait(lambda: room.state().left_m_s == room.state().right_m_s == 0, "the robot stands")
    phone.touch("#view")
    before = room.state().place
    assert before is not None
    width_m, height_m = 3.0, 4.0
    left, top, width, height = phone.run(
        "const b = document.querySelector('#world-view').getBoundingClientRect(); return [b.x, b.y, b.width, b.height];"
    )
    scale = min((width - 24) / width_m, (height - 24) / height_m)
    at = (
        left + (width - width_m * scale) / 2 + before.x_m * scale,
        top + (height + height_m * scale) / 2 - before.y_m * scale,
    )
    to = (at[0] - 1.2 * scale, at[1] + 0.8 * scale)
    phone.finger_down(*at)
    phone.finger_to(*to)
    phone.show("8-hand")
    assert room.state().place == before  # nothing is sent before it is put down
    phone.finger_up()
    phone.wait(lambda: (place := room.state().place) is not None and abs(place.x_m - 1.0) < 0.1, "it stands there")
    phone.touch("#view")


@pytest.mark.parametrize(
    "size",
    [
        pytest.param(PORTRAIT, id="portrait", marks=pytest.mark.deep),
        pytest.param(SMALL, id="small"),
        pytest.param(LANDSCAPE, id="landscape", marks=pytest.mark.deep),
        pytest.param(LAPTOP, id="laptop"),
    ],
)
def test_it_can_be_read_in_the_sun_and_touched_with_a_thumb(
    a_phone: Phone, room: Classroom, size: tuple[int, int]
) -> None:
    phone = a_phone
    begin(phone, room)
    phone.turn(size, touch=size != LAPTOP)
    for tab in TABS:
        if phone.shows(f"#tab-{tab}"):
            phone.touch(f"#tab-{tab}")
        phone.show(f"9-{size[0]}x{size[1]}-{tab}")
        assert_handy(phone, size, tab)


def assert_handy(phone: Phone, size: tuple[int, int], tab: str) -> None:
    """Assert contrast, target size and position of the visible elements."""
    for text, contrast in phone.run(TEXTS):
        assert contrast >= LEAST_CONTRAST, f"{tab}: {text!r} has a contrast of {contrast:.1f}"
    for name, width, height, left, right in phone.run(TARGETS):
        assert width >= LEAST_TARGET_PX, f"{tab}: {name} is {width} wide"
        assert height >= LEAST_TARGET_PX, f"{tab}: {name} is {height} high"
        assert left >= 0, f"{tab}: {name} begins at {left}"
        assert right <= size[0], f"{tab}: {name} ends at {right}"
    for name in ("#stop", "#go", "#rewind-says" if phone.shows("#rewind-bar") else "#sentence", "#link"):
        box = phone.run("return document.querySelector(arguments[0]).getBoundingClientRect().toJSON();", name)
        assert 0 <= box["top"] < box["bottom"] <= size[1], f"{tab}: {name} lies at {box}"
        assert 0 <= box["left"] < box["right"] <= size[0], f"{tab}: {name} lies at {box}"


OPINIONS = {1: "thinks good", -1: "thinks bad", None: "does not know this"}
TURNS = ("straight_on", "turn_left", "turn_right")


def pressed(phone: Phone) -> list[str]:
    return phone.texts("#behaviours [aria-pressed=true]")


def test_several_behaviours_have_a_button_each(a_lesson: Lesson) -> None:
    def prepare(robot: FakeRobot) -> None:
        robot.greeting = replace(A_HELLO, behaviours=TURNS)

    a_lesson.begin(prepare, behaviour="straight_on")
    phone = a_lesson.phone
    phone.wait(lambda: pressed(phone) == ["straight on"], "what is wanted is marked")
    assert "straight on" in phone.text("#sentence")
    phone.touch("[data-behaviour=turn_left]")
    phone.wait(lambda: phone.text("#said") == "pursue done", "the robot has taken it")
    assert a_lesson.told("pursue") == ["turn_left"]
    assert pressed(phone) == ["straight on"]  # what it is told counts, not what was touched
    a_lesson.show(behaviour="turn_left")
    phone.wait(lambda: pressed(phone) == ["turn left"], "the robot follows it")
    for size in (PORTRAIT, SMALL, LANDSCAPE, LAPTOP):
        phone.turn(size, touch=size != LAPTOP)
        phone.show(f"8-behaviours-{size[0]}x{size[1]}")
        assert_handy(phone, size, "teach")
    a_lesson.show(teacher="ann")
    phone.wait(lambda: phone.run("return document.querySelector('#behaviours').inert"), "it is the teacher's")


def test_one_behaviour_has_no_button(a_phone: Phone, room: Classroom) -> None:
    begin(a_phone, room)
    assert not a_phone.shows("#behaviours")


def test_the_critic_of_a_robot_that_drives_is_taught_by_touch(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone
    begin(phone, room)
    phone.touch("#tab-more")
    phone.touch("[data-phase='4']")
    phone.wait(lambda: room.state().phase == 4, "phase 4")
    phone.touch("#tab-teach")
    phone.wait(lambda: phone.shows("#critic"), "the page has its buttons")
    for appraisal in ("good", "bad"):
        phone.touch(f"[data-appraisal={appraisal}]")
        phone.wait(lambda: appraisal in said(phone), "the order is told")  # noqa: B023 - or that it says so already
        # The robot is elsewhere by now, and its averages move while it stands, too: the critic may think otherwise.
        phone.wait(lambda: OPINIONS[room.state().opinion] in phone.text("#opinion"), "the page says what it thinks")
    phone.show("12-critic")
    phone.touch("#tab-more")
    phone.touch("[data-phase='1']")
    phone.wait(lambda: not phone.shows("#critic"), "phase 1 is calm")
