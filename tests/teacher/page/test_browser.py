"""The page in a real browser, with the real client and a simulated robot: what a teacher with a phone lives through."""

import itertools
from functools import partial

from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.teaching.commands import Resume, Undo
from tests.teacher.page.classroom import Classroom
from tests.teacher.page.phone import LAPTOP, PORTRAIT, Phone
from tests.teacher.page.screens import on_each_screen

ACTIONS = ("along_left_wall", "forward", "curve_right", "spin_right", "bear_left")


def lessons_shown(phone: Phone) -> int:
    return int(
        phone.run("return document.querySelectorAll('#lesson-list li:not(.undone, .contradicts) button').length;")
    )


def no_picture(phone: Phone) -> bool:
    return phone.shows("#no-picture")


def said(phone: Phone) -> str:
    phone.wait(lambda: not phone.has("#said.pending"), "an answer")
    assert phone.has("#said.saved"), phone.text("#said")
    return phone.text("#said")


def begin(phone: Phone, room: Classroom) -> Phone:
    """Open the page and be the teacher; return the phone."""
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
    return phone


def hold_stick(phone: Phone, room: Classroom) -> None:
    """Put a finger on the circle and push it forward, until the robot drives."""
    phone.touch("#tab-drive")
    x, y = phone.middle("#stick")
    phone.finger_down(x, y)
    phone.finger_to(x, y - 60)
    phone.wait(lambda: room.state().by_hand and room.state().left_m_s > 0.05, "the robot drives by hand")


def test_a_teacher_teaches_drives_loses_the_link_and_comes_back(a_phone: Phone, room: Classroom) -> None:
    phone = a_phone

    # The code of the pairing opens the page; the robot shows itself and knows nothing.
    phone.open(room.address)
    phone.wait(lambda: phone.text("#sentence") == "I know nothing yet, teach me", "the robot asks")
    phone.complaints()  # of the page before, whose server is gone
    phone.show("1-no teacher-teaches")
    phone.touch("#claim-button")
    phone.wait(lambda: room.state().teacher == "local", "this device teaches")
    phone.wait(lambda: not phone.shows("#claim"), "this page has control")
    phone.show("2-it-asks")

    # An action that is held drives the robot and teaches it; its lessons are undone together.
    phone.finger_down(*phone.middle("[data-action=forward]"))
    phone.wait(lambda: room.state().by_hand and room.state().left_m_s > 0.05, "it drives")
    phone.wait(lambda: room.state().rlas > 0, "it is taught")
    phone.finger_up()
    phone.wait(lambda: not room.state().by_hand, "it is released")
    assert room.state().stopped is None
    phone.wait(lambda: phone.shows("#offer"), "the lessons can be undone")
    phone.touch("#offer")
    phone.wait(lambda: not room.state().rlas, "all are undone")
    phone.wait(lambda: lessons_shown(phone) == 0, "the page knows")

    # Three lessons by touching actions: answers while it asks, corrections while it drives.
    for action in itertools.cycle(ACTIONS):
        phone.wait(lambda: not phone.has("#actions[aria-busy=true]"), "it may be taught again")
        before = lessons_shown(phone)
        phone.touch(f"[data-action={action}]")
        if "says" in said(phone):
            continue  # it knew that already
        phone.wait(lambda: lessons_shown(phone) == before + 1, "one lesson more")  # noqa: B023 - called at once
        if before == 0:
            phone.wait(lambda: "does along left wall" in phone.text("#sentence"), "the lesson acts")
            phone.show("3-it-drives")
        if before == 2:
            break
    assert room.state().lessons == 3

    # The last one is taken back, with a second touch to be sure; a list that comes too late would refuse it.
    listed = "return document.querySelectorAll('#lesson-list li').length"
    phone.wait(lambda: phone.run(listed) >= 3, "the page's list has them all")
    phone.touch("#undo-last")
    assert phone.text("#undo-last .word") == "sure?"
    assert room.state().lessons == 3
    phone.touch("#undo-last")
    phone.wait(lambda: room.state().lessons == 2, "the lesson is undone")
    assert said(phone).startswith("undone")
    phone.touch("#tab-lessons")
    phone.wait(lambda: "undone" in phone.text("#lesson-list li"), "the list says so")
    phone.show("4-lessons")

    # A finger on the circle drives the robot; lifted, it stands until GO.
    room.put_robot_in_the_open()
    hold_stick(phone, room)
    phone.wait(lambda: phone.text("#sentence") == "You drive by hand", "the page says who drives")
    phone.show("5-by-hand")
    phone.finger_up()
    phone.wait(lambda: not room.state().by_hand and room.state().left_m_s == 0, "the robot stands")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")
    phone.show("6-let-go")

    # The link breaks while the circle is held: no picture, and the press is over for good.
    hold_stick(phone, room)
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
    for tab in ("drive", "lessons", "more", "teach"):
        phone.touch(f"#tab-{tab}")
        on_each_screen(phone, f"9-{tab}")


def test_a_page_whose_scripts_stand_still_lets_go_of_the_robot(a_phone: Phone, room: Classroom) -> None:
    phone = begin(a_phone, room)
    hold_stick(phone, room)
    room.time.pass_server_time(1.0)
    assert not room.state().by_hand
    assert room.state().left_m_s == 0
    phone.wait(lambda: not phone.has("#stick.held"), "the circle lets go")
    phone.finger_up()


def stand(phone: Phone, room: Classroom) -> None:
    """Stop the robot, and let it drive again: whatever a key does after it is seen."""
    phone.touch("#stop")
    phone.wait(lambda: "stands until" in phone.text("#said"), "the robot answers")
    after = room.state().tick
    phone.wait(lambda: room.state().tick > after + 20, "pictures from after it")
    assert room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")


def test_keyboard_drives_while_a_key_is_held_and_stops(a_phone: Phone, room: Classroom) -> None:
    phone = begin(a_phone, room)
    phone.turn(LAPTOP, touch=False)
    # The browser keeps the end of a key to itself while another key or a menu is open.
    phone.key("keyDown", "KeyW")
    phone.wait(lambda: room.state().by_hand and room.state().left_m_s > 0.05, "the robot drives by hand")
    phone.run("document.querySelector('#stage').dispatchEvent(new MouseEvent('contextmenu', {bubbles: true}))")
    phone.wait(lambda: not room.state().by_hand, "the robot stands")
    phone.key("keyUp", "KeyW")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")
    phone.key("keyDown", "Enter")
    phone.wait(lambda: room.state().stopped is None, "the robot may drive")
    phone.key("keyDown", "Space")
    phone.wait(lambda: room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local"), "the robot was stopped")
    phone.wait(lambda: phone.has("#go:enabled"), "GO is offered")
    phone.run("document.querySelector('#show-keys').focus()")
    phone.key("keyDown", "Enter")  # it belongs to the button that has the focus
    phone.wait(lambda: phone.shows("#keys"), "the list of keys opens")
    phone.key("keyDown", "Enter")
    phone.wait(lambda: not phone.shows("#keys"), "the list of keys closes")
    assert room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local")


def test_two_quick_touches_while_it_asks_are_one_lesson(a_phone: Phone, room: Classroom) -> None:
    phone = begin(a_phone, room)
    for _ in range(room.state().lessons):
        assert room.time.pass_until(lambda: room.client.send(Undo)).accepted
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
    resumed = partial(room.client.send, Resume)
    phone.wait(lambda: room.time.pass_until(resumed).accepted and room.state().stopped is None, "the robot may drive")
    phone.touch("#stop")
    phone.wait(lambda: "no link" in phone.text("#said"), "the page says that STOP waits")
    assert phone.text("#stop") == "STOP …"
    phone.run("shut = false")
    phone.wait(lambda: room.state().stopped == ActiveStop(StopReason.SAID_STOP, "local"), "the robot was stopped")
    phone.wait(lambda: phone.text("#stop") == "STOP", "STOP was answered")


def test_a_page_that_is_left_lets_go_of_the_robot(a_phone: Phone, room: Classroom) -> None:
    phone = begin(a_phone, room)
    hold_stick(phone, room)
    phone.open("about:blank")
    phone.wait(lambda: not room.state().by_hand and room.state().left_m_s == 0, "the robot stands")
    phone.finger_up()
