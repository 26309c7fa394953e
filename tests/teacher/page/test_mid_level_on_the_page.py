"""The mid level on the page: it asks which way, it is corrected and overridden; goals are named and sought."""

import re
from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.hello import MidIntroduction
from kurt2rt.core.decision.goal import NamedGoal
from tests.channel.states import COMMANDS
from tests.teacher.page.classroom import classroom
from tests.teacher.page.fake_robot import A_HELLO, FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import LAPTOP, PORTRAIT, Phone
from tests.teacher.page.screens import on_each_screen
from tests.teacher.page.test_critic_on_the_page import ACTIONS

TURNS = ("straight_on", "turn_left", "turn_right")
ASKS = replace(COMMANDS, rla=None, distance=7.0, asks=True, nearest_behaviour="turn_right")
READY = "return !document.querySelector('.turned, [aria-busy=true]');"
CALM = "return !document.querySelector('.pending, .saved:not(#said)') && !document.getAnimations().length;"


class Junction:
    """A robot with a mid level at a junction, and the page that its teacher has open."""

    def __init__(self, lesson: Lesson) -> None:
        self.phone = lesson.phone
        self.robot = lesson.robot
        self.show = lesson.show
        self.reads = lesson.reads

    def ask_which_way(self) -> None:
        """Stop the robot at a question: the mid level does not know this way."""
        stands = {"cause": "unknown", "action": None, "rla": None, "left_m_s": 0.0, "right_m_s": 0.0}
        near = {"nearest": 12, "nearest_action": "turn_right", "distance": 7.0, "radius": 6.0}
        self.show(mid=ASKS, asks_at="mid", **stands, **near)
        self.reads("#sentence", "Which way? I don't know, teach me")

    def drive_on(self) -> None:
        """Let the mid level decide."""
        drives = {"cause": "rla", "action": "forward", "rla": 1, "left_m_s": 0.3, "right_m_s": 0.3}
        near = {"nearest": 1, "nearest_action": "forward", "distance": 300.0, "radius": 700.0}
        self.show(mid=COMMANDS, asks_at="basic", **drives, **near)
        self.reads("#sentence", "RLA 1 of turn left does forward")

    def told(self, name: str) -> list[tuple[object, ...]]:
        """Return the calls of the robot of one name, without the tick that was meant."""
        return [(each[1], *each[3:]) for each in self.robot.told if each[0] == name]

    def touch_way(self, way: str) -> None:
        """One of the big buttons, once it may be touched."""
        self.phone.wait(lambda: self.phone.run(READY), "it may be taught")
        self.phone.touch(f"[data-way={way}]")


@pytest.fixture
def junction(a_lesson: Lesson) -> Junction:
    def prepare(robot: FakeRobot) -> None:
        mid = MidIntroduction("history", 12, 6.0)
        robot.greeting = replace(A_HELLO, actions=ACTIONS, behaviours=TURNS, mid=mid, seeks=True)
        robot.named = ("door", "window")

    a_lesson.begin(prepare, behaviour="turn_left", mid=COMMANDS)
    a_lesson.reads("#sentence", "RLA 1 of turn left does forward")
    return Junction(a_lesson)


def test_line_has_the_choice_of_the_mid_level_and_its_symbols(junction: Junction) -> None:
    phone = junction.phone
    junction.reads("#mid-sentence", "turn left because mid-level RLA 12: 2 of 12 differ, R 6")
    assert not phone.shows("#behaviours")
    assert phone.has('#strip[aria-label="passed: straight, left, left, straight, right, straight, left"]')
    arrows = phone.run("return [...document.querySelectorAll('#strip i')].map((e) => e.title);")
    assert arrows[-3:] == ["straight", "left", "turn left"]  # time goes to the right, what it wants now is last


def test_it_asks_which_way_and_big_buttons_answer(junction: Junction) -> None:
    phone = junction.phone
    junction.ask_which_way()
    assert "RLA 12" in phone.text("#nearest")
    assert "turn right" in phone.text("#nearest")
    assert phone.text("#gauge-text") == "7 of 12 differ, R 6"
    differing = phone.run("return document.querySelectorAll('#differences .differs').length;")
    assert differing == 2
    for each in TURNS:
        box = phone.run(f"return document.querySelector('[data-way={each}]').getBoundingClientRect().toJSON();")
        assert box["width"] > 90
        assert box["height"] > 70
    assert not phone.shows("#actions")
    on_each_screen(phone, "13-which-way")
    junction.touch_way("turn_right")
    phone.wait(lambda: junction.told("/answer") == [("turn_right", "mid", False)], "an answer to the mid level")
    assert junction.told("/correct") == []


def test_mid_level_is_corrected_extended_and_overridden(junction: Junction) -> None:
    phone = junction.phone
    junction.reads("#mid-sentence", "turn left because")
    junction.touch_way("straight_on")
    phone.wait(lambda: junction.told("/correct") == [("straight_on", "mid")], "a correction of the mid level")
    phone.touch("[data-meant=also]")
    junction.touch_way("turn_right")
    phone.wait(lambda: junction.told("/answer") == [("turn_right", "mid", True)], "an alternative")
    phone.touch("[data-meant=once]")
    phone.show("13-once")
    junction.touch_way("turn_right")
    phone.wait(lambda: junction.told("/pursue") == [("turn_right",)], "no lesson")
    pressed = phone.text("#meant [aria-pressed=true]")
    assert pressed.startswith("right")  # the next touch is a lesson again
    junction.show(mid=replace(COMMANDS, behaviour="turn_right", rla=None, overridden=True))
    junction.reads("#mid-sentence", "turn right by the teacher's choice, until it has finished")
    assert junction.told("/correct") == [("straight_on", "mid")]


def test_question_of_the_basic_level_changes_the_buttons(junction: Junction) -> None:
    phone = junction.phone
    junction.show(cause="unknown", asks_at="basic", action=None, rla=None, distance=812.0)
    phone.wait(lambda: phone.shows("#actions"), "the actions are offered")
    assert not phone.shows("#ways")
    junction.drive_on()
    phone.wait(lambda: phone.shows("#ways"), "the ways are back")
    phone.touch("[data-level=basic]")
    phone.wait(lambda: phone.shows("#actions"), "the teacher wants to teach actions")
    phone.wait(lambda: phone.run(READY), "it may be taught")
    phone.touch("[data-action=back]")
    phone.wait(lambda: ("back", True) in junction.told("/correct"), "a correction of the basic level")


def test_places_get_names_and_are_sought(junction: Junction) -> None:
    phone = junction.phone
    phone.touch("#tab-goals")
    junction.reads("#goal-list", "window")
    junction.reads("#goal-now", "no goal")
    phone.write("#situation-name", "lift")
    phone.touch("#name-situation")
    phone.wait(lambda: junction.told("/name") == [("lift",)], "this place has a name")
    junction.robot.named = ("door", "lift", "window")
    junction.show(lessons=2)
    junction.reads("#goal-list", "lift")
    phone.touch("[data-name=door] [aria-label='Seek door']")
    phone.wait(lambda: junction.told("/seek") == [(NamedGoal("door"),)], "it is to go there")
    junction.show(goal="door", plan=("turn_left", "straight_on"), plan_says="on the way to door: 2 ways left")
    junction.reads("#goal-now", "on the way to door: 2 ways left")
    junction.reads("#mid-sentence", "turn left because it leads to door, mid-level RLA 12")
    assert phone.text("#plan").endswith("turn left, straight on")
    phone.wait(lambda: phone.run(CALM), "the colours of an answer are gone")
    on_each_screen(phone, "13-goals")
    phone.touch("[data-name=lift] [aria-label^='Is here']")
    assert junction.told("/here") == []
    phone.touch("[data-name=lift] [aria-label^='Is here']")
    phone.wait(lambda: junction.told("/here") == [("lift",)], "it was set down there")
    phone.touch("#stop-seeking")
    phone.wait(lambda: any(each[0] == "/seek/stop" for each in junction.robot.told), "no goal any more")
    phone.touch("#tab-teach")
    assert phone.complaints() == []


def test_robot_without_a_mid_level_shows_none(a_lesson: Lesson) -> None:
    def prepare(robot: FakeRobot) -> None:
        robot.greeting = replace(A_HELLO, actions=ACTIONS, behaviours=TURNS)

    a_lesson.begin(prepare, behaviour="straight_on")
    phone = a_lesson.phone
    for size in (PORTRAIT, LAPTOP):
        phone.turn(size, touch=size != LAPTOP)
        for name in ("#mid", "#levels", "#ways", "#meant", "#tab-goals", "#goals", "#surprise"):
            assert not phone.shows(name), name
        assert phone.shows("#behaviours")
        assert phone.shows("#actions")


@pytest.mark.deep
def test_a_robot_in_the_streets_is_taught_which_way_and_how(
    a_phone: Phone, tmp_path_factory: pytest.TempPathFactory
) -> None:
    phone = a_phone
    with classroom(tmp_path_factory.mktemp("streets"), phone, "route") as room:
        phone.turn(PORTRAIT)
        phone.open(room.address)
        phone.wait(lambda: "Which way? I know none yet" in phone.text("#sentence"), "it asks which way")
        phone.complaints()  # of the page before, whose server is gone
        phone.touch("#claim-button")
        phone.wait(lambda: not phone.shows("#claim"), "this page has control")
        phone.show("14-which-way")
        phone.touch("[data-way=turn_left]")
        phone.wait(lambda: "I know nothing of turn left yet" in phone.text("#sentence"), "now it asks how")
        assert re.findall(r"\d+", phone.text("#mid-sentence")) == ["1", "0", "12", "6"]
        phone.wait(lambda: phone.shows("#actions"), "the actions are offered")
        phone.wait(lambda: phone.run(READY), "it may be taught again")
        phone.touch("[data-action=forward]")
        phone.wait(lambda: "RLA 2 of turn left does forward" in phone.text("#sentence"), "it drives")
        phone.show("14-it-drives")
        phone.wait(lambda: phone.shows("#ways") and phone.run(READY), "the ways are back")
        phone.touch("[data-meant=once]")
        phone.touch("[data-way=straight_on]")
        phone.wait(lambda: "teacher's choice" in phone.text("#mid-sentence"), "the teacher overrides it")
        answer = "follows straight_on until it has passed the next junction"
        phone.wait(lambda: phone.text("#said") == answer, "the robot answers")
        phone.touch("#tab-goals")
        phone.write("#situation-name", "home")
        phone.touch("#name-situation")
        phone.wait(lambda: "home" in phone.text("#goal-list"), "the place has a name")
        phone.touch("[aria-label='Seek home']")
        phone.wait(lambda: room.state().goal == "home", "it seeks it")
        phone.wait(lambda: "home" in phone.text("#goal-now"), "and says so")
        phone.show("14-it-seeks")
        phone.touch("#stop-seeking")
        phone.wait(lambda: room.state().goal == "", "no more")
        assert phone.complaints() == []
