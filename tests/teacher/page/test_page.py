"""The page in a real browser, with a robot that answers as the test says: what each control sends and shows."""

import hashlib
import io
import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.hello import AppraisalName, MidIntroduction
from kurt2rt.channel.protocol.lesson_list import Contradicting
from kurt2rt.channel.protocol.simulation import ExamStatus, WorldVerdict
from kurt2rt.channel.protocol.state import HoldState, ShownState
from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.goal import NamedGoal
from kurt2rt.core.decision.standing import ActiveStop, Standing, StopReason
from kurt2rt.core.perception.sensor_words import infrared_law, words_for
from kurt2rt.core.progress import Progress
from kurt2rt.core.teaching.question import FeatureDifference
from tests.channel.states import COMMANDS
from tests.runs.explain.helpers import facts, level, story
from tests.service.health.reports import ILL, SILENT
from tests.teacher.page.axe import violations
from tests.teacher.page.fake_robot import A_HELLO, A_LESSON, A_PLACE, A_SIMULATION
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LAPTOP, PORTRAIT, Phone
from tests.teacher.page.screens import LEAST_CONTRAST, TEXTS, on_each_screen

ACTIONS = (
    *("forward", "back", "stand", "bear_left", "bear_right", "curve_left", "curve_right", "spin_left", "spin_right"),
    *("quarter_turn_left", "quarter_turn_right", "along_left_wall", "along_right_wall"),
    *("sharp_left", "sharp_right", "flee", "whirl_left", "whirl_right"),
)
STANDS = {"action": None, "rla": None, "left_m_s": 0.0, "right_m_s": 0.0}
SPIN_LEFT = "[data-action=spin_left]"


def of_robot(**greeting: Any) -> dict[str, object]:
    """Return the fields of a robot with another description."""
    return {"greeting": replace(A_HELLO, **greeting)}


# Lessons and holds.


def finger_down(lesson: Lesson) -> None:
    """Put a finger on the button, and wait until its action is held."""
    lesson.phone.finger_down(*lesson.phone.middle(SPIN_LEFT))
    lesson.phone.wait(lambda: lesson.told("hold"), "the action is held")


def test_button_held_holds_and_tapped_corrects(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing())
    finger_down(a_lesson)
    assert phone.has(f"{SPIN_LEFT}.held")
    phone.wait(lambda: len(a_lesson.told("hold")) > 5, "it is sent again and again")
    phone.finger_up()
    phone.wait(lambda: a_lesson.robot.told_of("let_go"), "it is released")
    count = len(a_lesson.told("hold"))
    phone.pass_time(0.2)
    assert a_lesson.told("hold") == ["spin_left"] * count
    assert a_lesson.told("/correct") == [], "a hold is no tap"
    phone.touch(SPIN_LEFT)
    phone.wait(lambda: a_lesson.robot.told_of("/correct"), "a correction")
    assert a_lesson.robot.told_of("/correct")[0][3] is True, "a late one"
    assert len(a_lesson.told("hold")) == count


def test_hold_ends_with_the_page_and_does_not_come_back(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing())
    finger_down(a_lesson)
    phone.run("dispatchEvent(new Event('blur'))")
    phone.wait(lambda: a_lesson.robot.told_of("let_go"), "it is released")
    count = len(a_lesson.told("hold"))
    phone.pass_time(0.2)
    assert len(a_lesson.told("hold")) == count
    phone.finger_up()


def test_lessons_of_a_hold_are_counted_and_undone_together(a_lesson: Lesson) -> None:
    phone, held = a_lesson.begin(standing=Standing()), HoldState("local", "spin_left", "local-hold-7", 3, True)
    finger_down(a_lesson)
    a_lesson.show(hold=held, by_hand=True)
    a_lesson.reads("#said", "spin left is held, lessons: 3")
    phone.finger_up()
    a_lesson.show(hold=held._replace(lessons=4, on=False), by_hand=False)
    a_lesson.reads("#said", "spin left was held, lessons: 4")
    phone.touch("#offer")
    phone.wait(lambda: a_lesson.told("/undo") == ["local-hold-7"], "all are undone")


def test_lesson_that_contradicts_is_shown_and_undone_alone(a_lesson: Lesson) -> None:
    slip = Contradicting("local-hold-1/95", 7, "whirl_left", 4, ("forward", "bear_left"))
    hold = A_LESSON._replace(command_id="local-hold-1", text="held forward, whirl_left: 2 lessons", against=(slip,))
    phone = a_lesson.begin({"newest_lessons": (hold,)}, standing=Standing())
    phone.touch("#tab-lessons")
    a_lesson.reads("#lesson-list .contradicts", "RLA 7 says whirl left")
    phone.touch("#lesson-list .contradicts button")
    phone.touch("#lesson-list .contradicts button")
    phone.wait(lambda: a_lesson.told("/undo") == [slip.command_id], "the one lesson is undone")
    phone.touch("#tab-teach")


def test_page_that_only_watches_reads_lessons_and_explains(a_lesson: Lesson) -> None:
    phone = a_lesson.begin({"newest_lessons": (A_LESSON._replace(teacher="local"),)}, taught_by="local")
    a_lesson.reads("#sentence", "RLA 1 does forward, taught by you")
    phone.touch("#tab-lessons")
    assert phone.shows("#lesson-list button")
    a_lesson.show(teacher="ann")
    phone.wait(lambda: not phone.shows("#lesson-list button"), "this page may not undo")
    a_lesson.reads("#lesson-list", "you · phase 1")
    on_each_screen(phone, "25-watches")
    phone.touch("#sentence")
    a_lesson.reads("#explanation-says", "nothing was decided yet")
    phone.touch("#close-explanation")
    phone.touch("#tab-teach")
    a_lesson.reads("#claim-text", "ann is the teacher")


def test_shown_segments_are_taught_but_for_those_left_out(a_lesson: Lesson) -> None:
    shown = ShownState("local", 91, ("forward", "spin_left", "forward"), (100, 280, 340), (180, 60, 240))
    phone = a_lesson.begin(shown=shown, stopped=ActiveStop(StopReason.LET_GO, "local"), left_m_s=0.0, right_m_s=0.0)
    phone.touch("#tab-drive")
    phone.wait(lambda: phone.shows("#shown"), "the drive is offered")
    phone.touch("#shown-list button:nth-child(2)")
    assert phone.text("#teach-shown") == "Teach 2 of 3"
    phone.touch("#teach-shown")
    phone.wait(lambda: a_lesson.robot.told_of("/shown"), "the confirmation is sent")
    assert a_lesson.robot.told_of("/shown") == [("/shown", 91, (0, 2))]


# The past.

DRIVE_FROM, DRIVE_TO, EACH = 1000, 1600, 100
_PICK = """
const slider = document.querySelector('#rewind-time');
slider.value = arguments[0];
slider.dispatchEvent(new Event('input'));
"""
_TOUCH_AND_STOP = """
document.querySelector('[data-action=spin_left]').click();
document.querySelector('#stop').dispatchEvent(new PointerEvent('pointerdown'));
document.querySelector('#stop').click();
"""


@pytest.fixture
def past(a_lesson: Lesson) -> Lesson:
    """Return a lesson in rewind, whose robot drove for 6 s, each second by another RLA."""
    a_lesson.begin(standing=Standing(), tick=DRIVE_FROM, left_m_s=0.3, right_m_s=0.3)
    for tick in range(DRIVE_FROM + EACH, DRIVE_TO + 1, EACH):
        a_lesson.show(tick=tick, rla=tick // EACH, clock_s=tick / EACH)
        a_lesson.reaches(f"0:{tick // EACH}")
    a_lesson.phone.touch("#rewind")
    a_lesson.phone.wait(lambda: a_lesson.phone.shows("#rewind-bar"), "the past is shown")
    a_lesson.show(left_m_s=0.0, right_m_s=0.0)
    return a_lesson


def test_rewind_corrects_the_picked_tick_and_drives_on(past: Lesson) -> None:
    phone = past.phone
    assert past.robot.told_of("stop")
    past.show(tick=DRIVE_TO + 6000)  # the teacher thinks
    phone.run(_PICK, -3)
    past.reads("#rewind-says", "3.0 s before it stood: RLA 13 ")
    phone.touch("#rewind-go")
    phone.touch(SPIN_LEFT)
    phone.wait(lambda: past.robot.told_of("/resume"), "the robot is told to drive on")
    ((_, action, tick),) = past.robot.told_of("/correct")
    assert action == "spin_left"
    assert abs(tick - 1300) < EACH / 2
    names = [command[0] for command in past.robot.told]
    assert names.index("/correct") < names.index("/resume")
    phone.wait(lambda: phone.shows("#why"), "the present is shown")


_INSIDE = """
const box = document.querySelector(arguments[0]).parentElement.getBoundingClientRect();
const parts = [...document.querySelectorAll(`${arguments[0]} p`)].map((each) => each.getBoundingClientRect());
const inside = (each) => each.top >= box.top && each.right <= box.right && each.bottom <= box.bottom;
return parts.length && parts.every(inside);
"""


def assert_whole(phone: Phone, selector: str) -> None:
    """Assert that the element around cuts none of its paragraphs."""
    assert phone.run(_INSIDE, selector), f"{selector} is cut"


_MARK = """
const mark = document.querySelector(`#marks .${arguments[0]}`).getBoundingClientRect();
return [mark.x + mark.width / 2, mark.y + mark.height / 2];
"""


def test_time_line_shows_a_bump_where_it_was(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing(), tick=DRIVE_FROM, left_m_s=0.3, right_m_s=0.3)
    for second, touches in enumerate((0, 0, 1, 0, 0, 0, 0), start=1):
        place = A_PLACE._replace(x_m=second / 10)
        a_lesson.show(tick=DRIVE_FROM + second * EACH, clock_s=second, bumpers=touches, rla=second, place=place)
        a_lesson.reaches(f"0:0{second}")
    phone.turn(LAPTOP)
    bar = phone.run("return document.querySelector('#rewind-time').getBoundingClientRect().toJSON();")
    x, y = phone.run(_MARK, "bump")
    assert abs(x - (bar["right"] - 0.4 * bar["width"])) < 4, "4 s before now, on a bar of 10 s"
    phone.finger_down(x + 5, y)  # a finger is not that exact
    phone.finger_up()
    a_lesson.reads("#rewind-says", "4.0 s before it stood, where it touched something: RLA 3 ")
    assert a_lesson.robot.told_of("stop"), "a robot that drives is stopped"
    phone.touch("[data-step='-1']")
    a_lesson.reads("#rewind-says", "4.0 s before it stood: RLA 3 ")
    on_each_screen(phone, "24-time-line", also=lambda: assert_whole(phone, "#legend"))
    assert_accessible(phone, "looks back")
    phone.touch("#rewind-close")


def test_then_go_does_not_lift_a_stop_after_the_touch(past: Lesson) -> None:
    past.phone.touch("#rewind-go")
    before = len(past.robot.told_of("stop"))
    # Both in one turn of the page's loop, so that the stop comes before the answer to the lesson.
    past.phone.run(_TOUCH_AND_STOP)
    past.phone.wait(lambda: past.robot.told_of("/correct"), "the lesson is given")
    past.phone.wait(lambda: len(past.robot.told_of("stop")) > before, "STOP is sent")
    past.phone.pass_time(0.3)
    assert not past.robot.told_of("/resume")
    past.phone.touch("#rewind-close")


# Gamepad.

# One pad of the standard mapping, as the browser would tell of it.
PAD = """
window.pad = {index: 0, id: "pad", connected: true, mapping: "standard", axes: [0, 0, 0, 0], timestamp: 0,
  buttons: Array.from({length: 17}, () => ({pressed: false, touched: false, value: 0}))};
window.pads = [null];
navigator.getGamepads = () => pads;
window.tellPad = (kind) => {
  const event = new Event(kind);
  event.gamepad = pad;
  dispatchEvent(event);
};
window.shoulder = (held) => { pad.buttons[5] = {pressed: held, touched: held, value: Number(held)}; };
document.hasFocus = () => true;
pads[0] = pad;
tellPad('gamepadconnected');
"""
UNPLUG = "pads[0] = null; delete document.visibilityState; tellPad('gamepaddisconnected');"


@pytest.fixture
def driving(a_lesson: Lesson) -> Iterator[Lesson]:
    """Return a page with a new gamepad, whose buttons the page has seen released."""
    phone = a_lesson.begin()
    phone.run(PAD)
    a_lesson.reads("#said", "gamepad: hold a shoulder button")
    phone.pass_time(0.2)
    yield a_lesson
    phone.run(UNPLUG)
    phone.wait(lambda: not a_lesson.robot.pressing, "it lets go of the robot of this test")


def hold_shoulder(lesson: Lesson) -> None:
    phone = lesson.phone
    phone.run("shoulder(false)")
    phone.pass_time(0.2)
    phone.run("pad.axes = [0, -1, 0, 0]; shoulder(true)")
    phone.wait(lambda: lesson.robot.pressing and phone.has("#stick.held"), "the pad drives")


def test_gamepad_drives_while_its_shoulder_button_is_held(driving: Lesson) -> None:
    driving.phone.run("pad.axes = [0, -1, 0, 0]")
    driving.phone.pass_time(0.2)
    assert driving.robot.told_of("press") == [], "the stick alone drives nothing"
    hold_shoulder(driving)
    assert driving.robot.told_of("press")[-1] == ("press", 0.3, 0.3)
    driving.phone.run("shoulder(false)")
    driving.phone.wait(lambda: not driving.robot.pressing, "it lets go")


@pytest.mark.parametrize(
    "end",
    [
        "pad.connected = false; pads[0] = null; tellPad('gamepaddisconnected')",
        "Object.defineProperty(document, 'visibilityState', {value: 'hidden', configurable: true});"
        "document.dispatchEvent(new Event('visibilitychange'))",
    ],
    ids=["disconnected", "hidden"],
)
def test_gamepad_lets_go_for_good_until_pressed_again(driving: Lesson, end: str) -> None:
    hold_shoulder(driving)
    phone = driving.phone
    phone.run(end)
    phone.wait(lambda: not driving.robot.pressing, "it lets go")
    # The button is still held when all is well again: that is no new press.
    phone.run("pad.connected = true; delete document.visibilityState; pads[0] = pad; tellPad('gamepadconnected');")
    count = len(driving.robot.told_of("press"))
    phone.pass_time(0.2)
    assert len(driving.robot.told_of("press")) == count
    hold_shoulder(driving)


# Questions and standstills.

QUESTION = (
    FeatureDifference("maximum front", 441.0, 108.0),
    FeatureDifference("s9", 441.0, 108.0),
    FeatureDifference("s14", 70.0, 400.0),
    FeatureDifference("s17", 160.0, 160.4),
)
ASKS = {"cause": "unknown", "action": None, "rla": None, "distance": 1100.0, "question": QUESTION}
_GO = "const go = document.querySelector('#go'); return [go.disabled, getComputedStyle(go).outlineStyle];"


def test_latched_guard_is_the_reason_to_stand_and_go_stands_out(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing())
    assert phone.run(_GO) == [True, "none"]
    latched = Standing(StandReason.COMPUTER_TOO_SLOW, True, stall_s=0.12)
    a_lesson.show(standing=latched, left_m_s=0.0, right_m_s=0.0)  # cause and action stay those of the rule
    a_lesson.reads("#sentence", "Stands: the computer was too slow for 0.1 s. GO lets it drive on")
    assert phone.run(_GO) == [False, "solid"]
    phone.touch("#go")
    phone.wait(lambda: a_lesson.robot.told.count(("/resume",)) == 1, "the robot may drive on")


def test_question_is_announced_once_with_places_and_centimetres(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(of_robot(law=infrared_law(load_robot().infrared)))
    said = "return document.querySelector('#announce').textContent;"
    live = phone.run("return [...document.querySelectorAll('[role=status], [aria-live]')].map((e) => e.id);")
    assert (live, phone.run(said)) == (["announce"], "")
    a_lesson.show(**ASKS)
    phone.wait(lambda: phone.run(said) == "I don't know this situation, teach me", "the question is said")
    words = words_for(load_robot().infrared)
    # The nearest in front is that sensor, and the rear left edge reads the same to the centimetre.
    told = [words.difference(each.name, each.here, each.in_condition) for each in QUESTION[1:3]]
    assert phone.texts("#differences li") == [line.replace(" within 60 cm", "") for line in told]
    a_lesson.show(cause="rla", action="forward", rla=1, question=(), distance=300.0)
    phone.wait(lambda: phone.run(said) == "", "it asks no more")


def test_question_is_drawn_next_to_what_was_taught(a_lesson: Lesson) -> None:
    taught = level((200.0,) * 18, story(1, (90.0,) * 18, "forward", 1100.0))
    sensors = tuple(each.name for each in A_HELLO.sensors)
    phone = a_lesson.begin({"decided": facts(replace(taught, names=sensors), "unknown", None)})
    a_lesson.show(**ASKS)
    phone.wait(lambda: phone.shows("#compare"), "the condition has come")
    label = phone.run("return document.querySelector('#compare').getAttribute('aria-label');")
    assert label == "Now, and as taught: front left: 13 cm, was 46 cm; rear centre: nothing, was 15 cm"
    assert phone.text("#nearest") == "a bit like RLA 1: forward"
    on_each_screen(phone, "14-drawn")
    assert len(a_lesson.robot.told_of("why")) == 1, "it is asked of the robot once"
    a_lesson.show(distance=1200.0, nearest=2, lessons=2)
    a_lesson.reads("#nearest", "far from RLA 2: forward")
    assert not phone.shows("#compare"), "the robot told of another rule"


def test_open_question_keeps_its_words_while_noise_lets_it_drive(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing())
    phone.run("window.now = performance.now; window.heldMs = now() + 5000; performance.now = () => window.heldMs;")
    asks = Standing(StandReason.ASKS, asks=True)
    a_lesson.show(cause="unknown", action=None, rla=None, standing=asks, distance=710.0)
    a_lesson.reads("#sentence", "I don't know this situation, teach me")
    phone.run("window.heldMs += 1000;")
    a_lesson.show(clock_s=3600.0, cause="rla", action="forward", rla=1, distance=690.0)
    a_lesson.reaches("60:00")
    assert phone.text("#sentence") == "I don't know this situation, teach me"
    assert phone.text("#nearest") == "a bit like RLA 1: forward"
    again = Standing()
    a_lesson.show(cause="rla", action="forward", rla=2, image="mirrored", distance=0.0, standing=again, lessons=2)
    a_lesson.reads("#sentence", "RLA 2 mirrored does forward")
    assert phone.text("#gauge-text") == "just like RLA 1", "numbers are in the explanation"
    phone.run("performance.now = window.now;")  # the time that the tests pass, and no real one


# The room.

_WORLD = """
const canvas = document.querySelector("#world-view");
const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
"""
_PAINTED = (
    _WORLD
    + """
const box = document.querySelector("#stage");
let [painted, red] = [0, 0];
for (let i = 0; i < data.length; i += 4) {
  painted += data[i + 3] > 0;
  red += data[i + 3] > 0 && data[i] - data[i + 1] > 60;
}
const ratio = canvas.width / canvas.clientWidth;
return [painted / ratio ** 2 / (box.clientWidth * box.clientHeight), red];
"""
)


def test_room_fills_its_box_and_what_lies_ahead_is_red(a_lesson: Lesson) -> None:
    def painted() -> tuple[float, int]:
        share, red = a_lesson.phone.run(_PAINTED)
        return float(share), int(red)

    a_lesson.begin(of_robot(actions=ACTIONS, what="Follow the wall on its left"), left_m_s=0.0, right_m_s=0.0)
    a_lesson.phone.wait(lambda: painted()[0] > 0, "the room has come")
    standing, red = painted()
    a_lesson.show(left_m_s=0.6, right_m_s=0.6)  # its front sees 0.31 m
    a_lesson.phone.wait(lambda: painted()[1] > red + 50, "its way into what it sees is red")
    assert standing > 0.6
    a_lesson.show(place=None)
    a_lesson.phone.wait(lambda: a_lesson.phone.shows("#robot-view"), "without a room the robot is shown alone")
    assert not a_lesson.phone.shows("#world-view")


_BODY = (
    _WORLD
    + """
const pale = [...Array(data.length / 4).keys()].filter((i) => data[4 * i] === 0xdb && data[4 * i + 2] === 0xf5);
const middle = (of) => pale.reduce((sum, i) => sum + of(i), 0) / pale.length * canvas.clientWidth / canvas.width;
const box = canvas.getBoundingClientRect();
return [box.left + middle((i) => i % canvas.width), box.top + middle((i) => Math.floor(i / canvas.width))];
"""
)


def test_robot_is_dragged_along_the_axes_of_a_turned_room(a_lesson: Lesson) -> None:
    phone = a_lesson.begin()
    phone.wait(lambda: phone.shows("#world-view"), "the room has come")
    x, y = phone.run(_BODY)
    phone.drag_by_mouse(x, y, (x - 60, y + 30))
    phone.wait(lambda: a_lesson.robot.told_of("/world/place"), "it is put there")
    ((_, x_m, y_m, heading_rad),) = a_lesson.robot.told_of("/world/place")
    assert heading_rad == A_PLACE.heading_rad
    down, left = x_m - A_PLACE.x_m, A_PLACE.y_m - y_m
    assert (round(left / down, 1), left > 0.5) == (2.0, True), "the right of the picture is up in the room"


_BLUE = (
    _WORLD
    + """
const blue = [...Array(data.length / 4).keys()].filter((i) => data[4 * i] === 0x0b && data[4 * i + 2] === 0x8f);
const [xs, ys] = [blue.map((i) => i % canvas.width), blue.map((i) => Math.floor(i / canvas.width))];
const of = (pick, all) => all.reduce((a, b) => pick(a, b));
const least = [of(Math.min, xs), of(Math.min, ys), canvas.width - of(Math.max, xs), canvas.height - of(Math.max, ys)];
return of(Math.min, least) * canvas.clientWidth / canvas.width;
"""
)


def test_robot_that_faces_a_wall_is_whole_in_the_picture(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing())
    phone.wait(lambda: phone.shows("#world-view"), "the room has come")
    for turns, (x, y) in enumerate(((2.75, 2.0), (1.5, 3.75), (0.25, 2.0), (1.5, 0.25))):
        a_lesson.show(place=A_PLACE._replace(x_m=x, y_m=y, heading_rad=turns * math.pi / 2), clock_s=float(turns))
        a_lesson.reaches(f"0:0{turns}")
        assert phone.run(_BLUE) >= 3, f"body and handle are inside, with a margin, after {turns} turns"


# The mid level.

READY = "return !document.querySelector('.turned, [aria-busy=true]');"


@pytest.fixture
def junction(a_lesson: Lesson) -> Lesson:
    mid, turns = MidIntroduction("history", 12, 6.0), ("straight_on", "turn_left", "turn_right")
    robot = of_robot(actions=ACTIONS, behaviours=turns, mid=mid, seeks=True)
    a_lesson.begin({**robot, "named": ("door", "window")}, behaviour="turn_left", mid=COMMANDS)
    a_lesson.reads("#sentence", "RLA 1 of turn left does forward")
    return a_lesson


def touch_way(lesson: Lesson, way: str) -> None:
    """Touch one of the big buttons, once it may be touched."""
    lesson.phone.wait(lambda: lesson.phone.run(READY), "it may be taught")
    lesson.phone.touch(f"[data-way={way}]")


def test_mid_level_asks_and_is_answered_corrected_and_overridden(junction: Lesson) -> None:
    phone, robot = junction.phone, junction.robot
    asks = COMMANDS._replace(rla=None, distance=7.0, asks=True, nearest_behaviour="turn_right")
    near = {"nearest": 12, "nearest_action": "turn_right", "distance": 7.0, "radius": 6.0}
    junction.show(cause="unknown", mid=asks, asks_at="mid", **STANDS, **near)
    junction.reads("#sentence", "Which way? I don't know, teach me")
    assert phone.text("#gauge-text") == "7 of 12 differ"
    on_each_screen(phone, "13-which-way")
    touch_way(junction, "turn_right")
    phone.wait(lambda: robot.told_of("/answer"), "an answer to the mid level")
    drives = {"cause": "rla", "action": "forward", "rla": 1, "left_m_s": 0.3, "right_m_s": 0.3}
    junction.show(mid=COMMANDS, asks_at="basic", **drives, nearest=1, distance=300.0, radius=700.0)
    junction.reads("#mid-sentence", "turn left because mid-level RLA 12: 2 of 12 differ")
    touch_way(junction, "straight_on")
    phone.wait(lambda: robot.told_of("/correct"), "a correction of the mid level")
    phone.touch("[data-meant=also]")
    touch_way(junction, "turn_right")
    phone.wait(lambda: len(robot.told_of("/answer")) == 2, "an alternative")
    phone.touch("[data-meant=once]")
    touch_way(junction, "turn_right")
    phone.wait(lambda: robot.told_of("/pursue") == [("/pursue", "turn_right")], "no lesson")
    answers = [(each[1], *each[3:]) for each in robot.told_of("/answer")]
    assert answers == [("turn_right", "mid", False), ("turn_right", "mid", True)]
    assert [(each[1], *each[3:]) for each in robot.told_of("/correct")] == [("straight_on", "mid")]


def test_places_get_names_and_are_sought(junction: Lesson) -> None:
    phone = junction.phone
    phone.touch("#tab-goals")
    junction.reads("#goal-list", "window")
    phone.write("#situation-name", "lift")
    phone.touch("#name-situation")
    phone.wait(lambda: junction.told("/name") == ["lift"], "this place has a name")
    junction.robot.named = ("door", "lift", "window")
    junction.show(lessons=2)
    junction.reads("#goal-list", "lift")
    phone.touch("[data-name=door] [aria-label='Seek door']")
    phone.wait(lambda: junction.told("/seek") == [NamedGoal("door")], "it is to go there")
    junction.show(goal="door", plan=("turn_left", "straight_on"), plan_says="on the way to door: 2 ways left")
    junction.reads("#goal-now", "on the way to door: 2 ways left")
    assert phone.text("#plan").endswith("turn left, straight on")
    phone.touch("[data-name=lift] [aria-label^='Is here']")
    assert junction.told("/here") == []
    phone.touch("[data-name=lift] [aria-label^='Is here']")
    phone.wait(lambda: junction.told("/here") == ["lift"], "it was set down there")
    phone.touch("#stop-seeking")
    phone.wait(lambda: ("/seek/stop",) in junction.robot.told, "no goal any more")
    phone.touch("#tab-teach")


# The critic.


def test_phase_4_rewards_teach_the_critic_and_show_agreement(a_lesson: Lesson) -> None:
    appraisals = (AppraisalName("good", 1), AppraisalName("bad", -1), AppraisalName("neutral", 0))
    robot = of_robot(actions=ACTIONS, appraisals=appraisals, trusted_from=0.8)
    phone = a_lesson.begin(robot, phase=4, opinion=1, opinion_of=40, signals_missing=(6, 2))
    a_lesson.reads("#opinion", "critic: thinks good")
    assert phone.text("#trusted").startswith("not ")
    phone.touch("[data-appraisal=bad]")
    a_lesson.reads("#said", "/appraise done")
    phone.key("keyDown", "0")
    phone.wait(lambda: a_lesson.told("/appraise") == ["bad", "neutral"], "a key teaches it, too")
    assert a_lesson.told("/reward") == []
    a_lesson.show(opinion=-1, opinion_of=41, agreement=0.87, trusted=True, signals_missing=(0, 0))
    a_lesson.reads("#agreement-text", "0.87")
    assert phone.text("#trusted") == "trusted"
    on_each_screen(phone, "11-phase-4")
    a_lesson.show(phase=3, value=-0.08)
    phone.wait(lambda: not phone.shows("#critic"), "it is hidden before phase 4")
    phone.touch("#blame")
    phone.wait(lambda: a_lesson.told("/reward") == [-1], "a signal is the robot's reward again")


# Tables: health, why, exam, files, simulation.


def test_faults_are_coloured_with_time_and_cure(a_lesson: Lesson) -> None:
    phone = a_lesson.begin()
    later = a_lesson.show().tick + 100
    a_lesson.robot.report = replace(ILL, tick=later)
    a_lesson.show(tick=later)
    a_lesson.reads("#health", "sensors silent, …")
    assert phone.run("return document.querySelector('#health').className;") == "warns urgent"
    phone.touch("#link")
    a_lesson.reads("#phase", "1, Supervised")
    assert "90 rules of 8 actions" in phone.text("#health-rows")
    assert phone.run("return document.querySelector('#rules').textContent;") == "90 rules of 8 actions"
    a_lesson.reads("#health-troubles", f"{SILENT.what} (for 2 s): {SILENT.to_do}")
    on_each_screen(phone, "12-health")
    phone.touch("#stop")  # which is never covered
    phone.wait(lambda: a_lesson.robot.told_of("stop"), "the robot is stopped")
    phone.touch("#close-health")
    assert not phone.shows("#health-table")


def test_a_touch_on_its_sentence_tells_why_it_does_so(a_lesson: Lesson) -> None:
    phone, nearest = a_lesson.begin(), story(1, (120.0, 80.0), "forward", 5.0)
    a_lesson.robot.silent = True
    phone.touch("#sentence")
    a_lesson.reads("#explanation-says", "no answer")
    a_lesson.robot.silent = False
    a_lesson.robot.decided = facts(level((123.0, 84.0), nearest, story(2, (90.0, 88.0), "spin_left", 34.0)))
    phone.touch("#explain-again")
    a_lesson.reads("#explanation-lines", "The runner-up of 2 is RLA 2 (spin_left) at 34")
    rows = phone.text("#explanation-features").splitlines()
    assert rows[1].split()[1:] == ["84", "80", "64", "%"]  # after a heading, the feature that differs more
    phone.touch("#close-explanation")
    assert not phone.shows("#explanation")


def picture() -> bytes:
    content = io.BytesIO()
    Figure(figsize=(2.0, 2.0)).savefig(content, format="png")
    return content.getvalue()


def test_an_exam_ends_in_a_picture_and_a_verdict(a_lesson: Lesson) -> None:
    phone = a_lesson.begin()
    verdicts = (
        WorldVerdict("A", True, "4.86 of the teacher's 5.00 laps, no collision"),
        WorldVerdict("cave", False, "not judged: the policy itself gets nowhere here (0.02 laps)", judged=False),
    )
    over = ExamStatus(False, 1.0, "Passed in 1 of 1 worlds; 1 not judged.", verdicts, "wall-following.png")
    a_lesson.robot.files[over.picture] = picture()
    phone.touch("#tab-more")
    a_lesson.robot.examined = ExamStatus(True, 0.42, "exam without teacher, world b")
    phone.touch("#examine")
    a_lesson.reads("#exam-says", "42 %: exam without teacher, world b")
    a_lesson.robot.examined = over
    a_lesson.show(tick=a_lesson.show().tick + 50)
    a_lesson.reads("#exam-verdict", over.text)
    a_lesson.reads("#exam-worlds", "World cave: not judged")
    loaded = "const e = document.querySelector('#exam-picture'); return e.complete && e.naturalWidth;"
    phone.wait(lambda: phone.run(loaded), "the picture is there")
    on_each_screen(phone, "22-exam")
    phone.touch("#close-exam")
    assert not phone.shows("#exam-result")


def test_a_copy_is_downloaded_whole_and_another_loaded(a_lesson: Lesson, tmp_path: Path) -> None:
    phone, name, content = a_lesson.begin(), "walls.zip", bytes(range(256)) * 20
    a_lesson.robot.files[name] = content
    a_lesson.robot.answers_with = {"name": name, "sha256": "ab" * 32, "size": len(content)}
    phone.touch("#tab-more")
    phone.driver.execute_cdp_cmd(
        "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path), "eventsEnabled": False}
    )
    phone.touch("#export")
    phone.wait((tmp_path / name).exists, "the browser has stored it")
    assert (tmp_path / name).read_bytes() == content
    assert a_lesson.told("/export") == ["package"]
    phone.write("#load-file", str(tmp_path / name))
    phone.wait(lambda: a_lesson.robot.told_of("/load"), "it is uploaded")
    ((_, uploaded_as, uploaded),) = a_lesson.robot.told_of("upload")
    assert uploaded == content
    assert a_lesson.robot.told_of("/load") == [("/load", uploaded_as, hashlib.sha256(content).digest())]
    a_lesson.robot.refuses = "the file is too large (at most 8000000 bytes)"
    phone.write("#load-file", str(tmp_path / name))
    a_lesson.reads("#said", f"{name}: the file is too large (at most 8000000 bytes)")


def choose(phone: Phone, selector: str, value: str) -> None:
    phone.run("document.querySelector(arguments[0]).value = arguments[1];", selector, value)
    phone.run("document.querySelector(arguments[0]).dispatchEvent(new Event('input'));", selector)


def test_simulation_and_speed_of_lessons_are_chosen_in_more(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing(), phase=2)
    phone.touch("#tab-more")
    phone.wait(lambda: phone.run("return document.querySelector('#sim-task').value;"), "it knows what is simulated")
    choose(phone, "#lesson-speed", "60")
    phone.wait(lambda: a_lesson.told("/lesson/speed") == [60], "the robot is told")
    a_lesson.show(lesson_speed=0.35)
    phone.wait(lambda: "slow, 35 %" in phone.run("return document.querySelector('#phase').textContent;"), "it says so")
    assert phone.run("return document.querySelector('#sim-change').disabled;")
    choose(phone, "#sim-task", "eight")
    choose(phone, "#sim-world", "rooms-N")
    choose(phone, "#sim-number", "9007")
    on_each_screen(phone, "23-simulation")
    phone.touch("#sim-change")
    run = "/simulation/run"
    phone.wait(lambda: a_lesson.robot.told_of(run) == [(run, "rooms-9007", "eight", False)], "the next run is wanted")
    phone.touch("#sim-fresh")
    assert "Sure?" in phone.text("#sim-fresh")
    assert len(a_lesson.told(run)) == 1
    phone.touch("#sim-fresh")
    phone.wait(lambda: a_lesson.robot.told_of(run)[1:] == [(run, None, None, True)], "a new knowledge file is wanted")


def test_a_minute_without_help_suggests_the_exam(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(progress=Progress(60, 91, 1))
    a_lesson.reads("#drove-text", "91 %")
    a_lesson.show(progress=Progress(60, 99, 0))
    a_lesson.reads("#said", "It has not asked for a minute. Exam?")
    phone.touch("#offer")
    phone.wait(lambda: ("/exam",) in a_lesson.robot.told, "the exam begins")


def test_first_lap_suggests_exam_and_slow_computer_is_slowed(a_lesson: Lesson) -> None:
    phone = a_lesson.begin(standing=Standing())
    simulated = replace(A_SIMULATION, unit="laps")
    tick = itertools.count(10_000, 100)
    for speed, reached, laps in ((1, 1.0, 0.96), (1, 1.0, 1.02), (3, 2.4, 1.1)):
        a_lesson.robot.simulated = replace(simulated, speed=speed, reached=reached, progress=laps)
        a_lesson.show(tick=next(tick))
        a_lesson.reads("#measure", f"{laps:.1f} laps")
    assert phone.run("return saidBefore.join();").count("It has driven its first lap. Exam?") == 1
    for _ in range(4):
        phone.pass_time(1.0)
        a_lesson.show(tick=next(tick))
    a_lesson.reads("#said", "This computer is too slow for 3 times real time. It goes on in 2 times real time.")
    assert a_lesson.told("/simulation/speed") == [2]


# For all people.


def test_page_in_its_main_states_breaks_no_rule_of_axe(a_lesson: Lesson) -> None:
    robot = of_robot(what="Teach it to follow the wall on its left")
    phone = a_lesson.begin(robot, progress=Progress(60, 87, 3), **ASKS)
    a_lesson.reads("#differences", "front left")
    assert_accessible(phone, "asks")
    a_lesson.show(cause="rla", action="forward", rla=1, question=())
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


def assert_readable(texts: list[tuple[str, float]], what: str) -> None:
    assert texts
    for text, contrast in texts:
        assert contrast >= LEAST_CONTRAST, f"{what}: {text!r} has a contrast of {contrast:.1f}"


_TOPS = """
return [...document.querySelectorAll("#actions button, #rewards button, #tabs button, #go, #stop")]
  .filter((e) => e.checkVisibility()).map((e) => Math.round(e.getBoundingClientRect().top));
"""


def test_rare_actions_unfold_and_no_answer_moves_any(a_lesson: Lesson) -> None:
    long = "RLA 10 taught: back; all near it say curve_right, spin_right, forward (RLA 9 first)"
    asks = Standing(StandReason.ASKS, asks=True)
    phone = a_lesson.begin(of_robot(actions=ACTIONS), standing=asks, nearest_action="flee")
    scrolls = "const e = document.querySelector('#teach'); return e.scrollHeight - e.clientHeight;"
    assert phone.run("return document.querySelector('#stage').clientHeight") >= 240, "the picture has its room"
    assert (len(phone.texts("#actions [data-action]")), phone.run(scrolls)) == (13, 0)
    assert phone.has("#more-actions.nearest"), "the action of the nearest rule is a folded one"
    phone.touch("#more-actions")
    assert (len(phone.texts("#actions [data-action]")), phone.run(scrolls)) == (18, 0)
    a_lesson.robot.refuses = long
    before = phone.run(_TOPS)
    phone.run("document.querySelector('#praise').click()")
    a_lesson.reads("#said", long)
    assert phone.run(_TOPS) == before
