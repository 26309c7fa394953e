"""Bridge: control, presence, presses and commands of its pages."""

import json
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import anyio
import anyio.lowlevel
import pytest

from kurt2rt.channel.protocol.requests import CommandRequest, NextRunRequest, PlaceRequest
from kurt2rt.core.decision.goal import NamedGoal
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.outcome_text import Surface, text_of
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import (
    Appraise,
    Correct,
    HandOver,
    Pursue,
    Resume,
    Reward,
    Seek,
    SetLessonSpeed,
    SetPhase,
    Single,
    Take,
    Teach,
)
from kurt2rt.teacher.client.answer import local_refusal
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.messages import Hidden, PageCommand, PageHeartbeat, PageMessage, Press, Release, StopNow
from kurt2rt.teacher.page.page_connection import PageConnection
from kurt2rt.teacher.page.texts import PageNotice
from kurt2rt.teacher.page.texts import text_of as page_text_of
from tests.teacher.page.clock import Clock
from tests.teacher.page.fake_robot import FakeRobot
from tests.teacher.stand_in_robot import in_a_task_of_its_own

PLACE = "127.0.0.1:5683"
STALE = text_of(Outcome(RefusalCode.OLD_PICTURE), Surface.PAGE)
STOPPED = Outcome.of(RefusalCode.STOPPED_MEANWHILE, command="go")


async def settled() -> None:
    """Let all tasks run until they wait; anyio.wait_all_tasks_blocked is too slow because the bridge polls."""
    for _ in range(50):
        await anyio.lowlevel.checkpoint()


class Page:
    """Page without a browser."""

    def __init__(self, fixture: "BridgeFixture") -> None:
        self.fixture = fixture
        self.connection: PageConnection = fixture.bridge.connect()
        self.heard: list[dict[str, Any]] = []
        self.picture: int | None = None

    def say(self, message: PageMessage) -> None:
        self.fixture.bridge.on_message(self.connection, message)

    def read(self) -> list[dict[str, Any]]:
        """Return the messages since the last call."""
        news = []
        while (text := self.connection.pop(self.fixture.clock())) is not None:
            message = json.loads(text)
            self.picture = message.get("picture", self.picture)
            news.append(message)
        self.heard += news
        return news

    def last(self, kind: str) -> dict[str, Any]:
        self.read()
        return [each for each in self.heard if each["kind"] == kind][-1]

    def beat(self) -> None:
        self.say(PageHeartbeat(self.picture, 0.0))

    def press(self, press_id: int = 1, speed: float = 0.2) -> None:
        self.say(Press(press_id, speed, speed, self.picture))

    async def command(self, kind: type[Single | CommandRequest], /, **fields: object) -> dict[str, Any]:
        self.say(PageCommand(1, kind, fields, self.picture))
        await settled()
        return self.last("answer")

    async def see(self, **changes: Any) -> None:
        """Send a new state of the robot, and show it on the page."""
        self.fixture.robot.show(**changes)
        await settled()
        self.beat()
        self.read()
        self.beat()


class BridgeFixture:
    """Bridge with a fake robot and a clock that the test advances."""

    def __init__(self) -> None:
        self.robot = FakeRobot()
        self.clock = Clock()
        self.bridge = Bridge(self.robot, "phone", PLACE, now=self.clock)

    def told(self, *names: str) -> list[tuple[Any, ...]]:
        return [each for each in self.robot.told if each[0] in names]

    async def wait(self, seconds: float) -> None:
        """Advance the clock, in the bridge's steps."""
        for _ in range(round(seconds / 0.01)):
            self.clock.advance(0.01)
            self.bridge.poll()
        await settled()


@asynccontextmanager
async def opened() -> AsyncIterator[BridgeFixture]:
    fixture = BridgeFixture()
    async with anyio.create_task_group() as tasks:
        await tasks.start(fixture.bridge.run)
        yield fixture
        tasks.cancel_scope.cancel()


@pytest.fixture
async def fixture() -> AsyncIterator[BridgeFixture]:
    async with in_a_task_of_its_own(opened()) as opened_fixture:
        yield opened_fixture


@pytest.fixture
async def page(fixture: BridgeFixture) -> Page:
    return Page(fixture)


async def test_take_gives_the_second_page_control(fixture: BridgeFixture) -> None:
    first, second = Page(fixture), Page(fixture)
    await first.see()
    await fixture.wait(0.4)
    await second.see(teacher="phone")
    assert second.last("page")["seat"] == "elsewhere"
    assert not fixture.robot.watching, "a page without control keeps no presence"
    assert (await second.command(Teach, action="forward"))["why"] == "watching"
    second.press()
    assert second.last("let_go")["text"] == page_text_of(PageNotice.NOT_IN_CONTROL)
    assert fixture.told("press", "/answer") == []
    fixture.clock.advance(1.1)
    assert (await second.command(Take))["why"] == "stale"
    assert second.last("page")["seat"] == "elsewhere"

    await second.see()
    assert (await second.command(Take))["accepted"]
    assert second.last("page")["seat"] == "here"
    assert first.last("page")["seat"] == "elsewhere"
    assert fixture.told("/take") == []
    second.press()
    assert fixture.told("press") == [("press", 0.2, 0.2)]


async def test_stop_from_a_page_without_control_is_sent(fixture: BridgeFixture) -> None:
    driver, watcher = Page(fixture), Page(fixture)
    await driver.see(teacher="phone")
    driver.press()
    watcher.say(StopNow(5))
    await settled()
    assert watcher.last("answer")["accepted"]
    assert fixture.told("stop") == [("stop",)]
    driver.press()  # the same press still comes: it is over
    assert fixture.told("press") == [("press", 0.2, 0.2)]


async def test_heartbeats_keep_the_presence_for_300_ms(fixture: BridgeFixture, page: Page) -> None:
    assert not fixture.robot.watching
    await page.see()
    assert fixture.robot.watching
    await fixture.wait(0.29)
    assert fixture.robot.watching
    await fixture.wait(0.02)
    assert not fixture.robot.watching


async def test_silence_of_250_ms_ends_the_press(fixture: BridgeFixture, page: Page) -> None:
    await page.see(teacher="phone")
    page.press()
    await fixture.wait(0.24)
    assert fixture.robot.pressing
    await fixture.wait(0.02)
    assert fixture.told("let_go") == [("let_go",)]
    assert page.last("let_go")["text"] == page_text_of(PageNotice.PRESS_LOST)


async def test_presses_after_a_stall_do_not_drive(fixture: BridgeFixture, page: Page) -> None:
    await page.see(teacher="phone")
    page.press(press_id=1)
    await fixture.wait(0.5)
    for press_id in (1, 1, 2, 3):  # a burst: all given on the picture of half a second ago
        page.press(press_id=press_id)
    assert fixture.told("press") == [("press", 0.2, 0.2)]
    await page.see()
    page.press(press_id=4)
    assert len(fixture.told("press")) == 2


async def test_press_ended_by_the_robot_does_not_start_again(fixture: BridgeFixture, page: Page) -> None:
    await page.see(teacher="phone")
    page.press(press_id=1)
    fixture.robot.pressing, fixture.robot.refusal = False, local_refusal(RefusalCode.STOPPED_MEANWHILE, command="go")
    page.press(press_id=1)
    assert page.last("let_go")["text"] == text_of(STOPPED, Surface.PAGE)
    page.press(press_id=1)
    assert len(fixture.told("press")) == 1
    page.press(press_id=2)
    assert len(fixture.told("press")) == 2


async def test_release_ends_its_press_and_not_the_next_one(fixture: BridgeFixture, page: Page) -> None:
    await page.see(teacher="phone")
    page.press(press_id=1)
    page.say(Release())
    page.press(press_id=2)  # came with the release
    await settled()
    page.press(press_id=2)  # 50 ms later
    assert [each[0] for each in fixture.told("press", "let_go")] == ["press", "let_go", "press"]
    assert fixture.robot.pressing
    page.press(press_id=2)
    assert len(fixture.told("press")) == 3


DRIVING = {"teacher": "phone", "action": "forward", "phase": 1}


@pytest.mark.parametrize(
    ("how", "told"),
    [
        (lambda page: page.say(Release()), {("let_go",)}),
        (lambda page: page.say(Hidden()), {("let_go",), ("stop",)}),
        (lambda page: page.fixture.bridge.disconnect(page.connection), {("let_go",), ("stop",)}),
    ],
    ids=["released", "hidden", "closed"],
)
async def test_release_hiding_and_closing_end_what_they_have_to(
    fixture: BridgeFixture, page: Page, how: Callable[[Page], None], told: set[tuple[str]]
) -> None:
    await page.see(**DRIVING)
    page.press()
    how(page)
    fixture.robot.show()
    await settled()
    stops = fixture.told("let_go", "stop")
    assert (set(stops), len(stops)) == (told, len(told))
    is_shown = "state" in {each["kind"] for each in page.read()}
    assert fixture.robot.watching == is_shown == (("stop",) not in told)


@pytest.mark.parametrize("refuses", ["", "refused"])
async def test_ended_run_is_not_stopped_as_unseen(fixture: BridgeFixture, page: Page, refuses: str) -> None:
    await page.see(**DRIVING)
    fixture.robot.refuses = refuses
    await page.command(NextRunRequest, world="b", task=None, fresh=False)
    fixture.robot.refuses = ""
    page.say(Hidden())
    await settled()
    assert fixture.told("stop") == ([("stop",)] if refuses else [])


async def test_end_ends_only_a_press_that_is_held(fixture: BridgeFixture, page: Page) -> None:
    await page.see(teacher="phone")
    await fixture.bridge.end()
    assert fixture.told("let_go") == []
    page.press()
    await fixture.bridge.end()
    assert fixture.told("let_go") == [("let_go",)]
    assert not fixture.robot.watching


async def test_command_has_its_own_tick_or_that_of_the_page_s_state(fixture: BridgeFixture, page: Page) -> None:
    await page.see(tick=500)
    shown = page.picture
    await page.see(tick=600)
    page.picture = shown
    await page.command(Correct, action="spin_left", late=True)
    await page.command(Reward, value=-1)
    await page.command(Appraise, appraisal="bad")
    await page.command(Correct, action="spin_left", decision_tick=40)
    await page.command(Seek, goal=NamedGoal("door"))
    assert fixture.robot.told[-5:] == [
        ("/correct", "spin_left", 500, True),
        ("/reward", -1, 500),
        ("/appraise", "bad", 500),
        ("/correct", "spin_left", 40),
        ("/seek", NamedGoal("door")),
    ]


async def test_command_on_no_or_an_earlier_start_s_state_is_refused(fixture: BridgeFixture, page: Page) -> None:
    page.beat()
    assert (await page.command(Teach, action="forward"))["why"] == "stale"
    await page.see(boot=b"old!")
    fixture.robot.show(boot=b"new!")
    await settled()
    assert (await page.command(Teach, action="forward"))["why"] == "stale"
    assert fixture.told("/answer") == []


@pytest.mark.parametrize(
    ("longest_s", "kind", "fields"),
    [
        (1.0, Resume, {}),
        (1.0, Take, {}),
        (1.0, SetPhase, {"phase": Phase.AUTONOMOUS}),
        (1.0, PlaceRequest, {"x_m": 1.0, "y_m": 2.0, "heading_rad": 0.5}),
        (1.0, Pursue, {"behaviour": "turn_left"}),
        (3.0, Correct, {"action": "forward"}),
        (3.0, Appraise, {"appraisal": "bad"}),
        (3.0, SetLessonSpeed, {"percent": 60}),
        (3.0, HandOver, {"to": None}),
    ],
)
async def test_command_on_an_old_state_is_refused(
    fixture: BridgeFixture, page: Page, kind: type[Single | CommandRequest], fields: dict[str, object], longest_s: float
) -> None:
    await page.see()
    fixture.clock.advance(longest_s - 0.01)
    assert (await page.command(kind, **fields))["accepted"]
    told = len(fixture.told(kind.path))
    fixture.clock.advance(0.02)
    answer = await page.command(kind, **fields)
    assert (answer["why"], answer["text"]) == ("stale", STALE)
    assert len(fixture.told(kind.path)) == told


async def test_resume_on_a_state_before_a_stop_is_refused(fixture: BridgeFixture, page: Page) -> None:
    await page.see(stopped=ActiveStop(StopReason.SAID_STOP, "phone"))
    shown = page.picture
    fixture.clock.advance(0.1)
    await page.see(stopped=ActiveStop(StopReason.SAID_STOP, "anna"))
    page.picture = shown
    assert (await page.command(Resume))["why"] == "stopped"
    fixture.clock.advance(0.1)
    await page.see()
    fixture.clock.advance(0.1)
    page.say(StopNow(7))
    await page.command(Resume)
    assert fixture.told("/resume") == []
    await page.see()
    assert (await page.command(Resume))["accepted"]


async def test_refusal_and_missing_answer_reach_the_page(fixture: BridgeFixture, page: Page) -> None:
    await page.see()
    fixture.robot.refuses = "refused"
    assert (await page.command(Resume))["text"] == "refused"
    fixture.robot.silent = True
    assert (await page.command(Resume))["why"] == "unknown"
    page.press()
    page.say(Release())
    await settled()
    assert page.last("let_go")["text"] == page_text_of(PageNotice.STOP_UNANSWERED)


async def test_ninth_pending_command_is_busy_and_a_stop_is_sent(fixture: BridgeFixture, page: Page) -> None:
    await page.see()
    never = anyio.Event()

    async def wait_for_ever(*_: object) -> Any:
        await never.wait()

    fixture.robot.send = wait_for_ever  # type: ignore[method-assign, assignment]
    for _ in range(8):
        page.say(PageCommand(1, Resume, {}, page.picture))
        await settled()
    assert (await page.command(Resume))["why"] == "busy"
    page.say(StopNow(2))
    await settled()
    assert fixture.told("stop") == [("stop",)]


async def test_driving_robot_is_stopped_320_ms_after_a_heartbeat(fixture: BridgeFixture, page: Page) -> None:
    await page.see(**DRIVING)
    await fixture.wait(0.29)
    assert fixture.told("stop") == []
    await fixture.wait(0.03)
    assert fixture.told("stop") == [("stop",)]
    assert page.last("let_go")["text"] == page_text_of(PageNotice.UNSEEN_STOP)
    await fixture.wait(1.0)
    assert len(fixture.told("stop")) == 1


async def test_robot_that_starts_after_hiding_is_stopped(fixture: BridgeFixture, page: Page) -> None:
    await page.see(**{**DRIVING, "action": None})
    page.say(Hidden())
    await settled()
    assert fixture.told("stop") == []
    fixture.robot.show(action="forward")
    await settled()
    assert fixture.told("stop") == [("stop",)]
