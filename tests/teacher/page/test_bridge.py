"""What the bridge makes of its pages: who drives, who looks, who may order what, and when the robot is let go of."""

import json
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import anyio
import anyio.lowlevel
import pytest

from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.outcome_text import Surface, text_of
from kurt2rt.core.rla.rla import Phase
from kurt2rt.teacher.client.answer import local_refusal
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.messages import Hidden, PageHeartbeat, PageMessage, PageOrder, Press, Release, StopNow
from kurt2rt.teacher.page.page_connection import PageConnection
from tests.teacher.page.clock import Clock
from tests.teacher.page.fake_robot import A_PLACE, FakeRobot

NAMES = ("resume", "take", "set_phase", "place", "correct", "hand_over", "pursue")
STALE = text_of(Outcome(RefusalCode.OLD_PICTURE), Surface.PAGE)
STOPPED = Outcome.of(RefusalCode.STOPPED_MEANWHILE, command="go")


async def settled() -> None:
    """All that follows from what was said has been done: nothing here waits for anything but the next step of another.

    anyio.wait_all_tasks_blocked looks only each 100 ms, for the bridge's watch never is blocked.
    """
    for _ in range(50):
        await anyio.lowlevel.checkpoint()


class Page:
    """A page without a browser."""

    def __init__(self, hall: "Hall") -> None:
        self.hall = hall
        self.visitor: PageConnection = hall.bridge.arrive()
        self.heard: list[dict[str, Any]] = []
        self.picture: int | None = None

    def say(self, message: PageMessage) -> None:
        self.hall.bridge.hear(self.visitor, message)

    def read(self) -> list[dict[str, Any]]:
        """What came since the last call."""
        news = []
        while (text := self.visitor.take(self.hall.clock())) is not None:
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

    def press(self, hold: int = 1, speed: float = 0.2) -> None:
        self.say(Press(hold, speed, speed, self.picture))

    async def order(self, name: str, /, **arguments: object) -> dict[str, Any]:
        self.say(PageOrder(1, name, arguments, self.picture))
        await settled()
        return self.last("answer")

    async def see(self, **changes: Any) -> None:
        """A new picture of the robot comes, and the page has it on its screen."""
        self.hall.robot.show(**changes)
        await settled()
        self.beat()
        self.read()
        self.beat()


class Hall:
    """A bridge with a robot that does as it is told, and a clock that stands."""

    def __init__(self) -> None:
        self.robot = FakeRobot()
        self.clock = Clock()
        self.bridge = Bridge(self.robot, "phone", "127.0.0.1:5683", now=self.clock)

    def told(self, *names: str) -> list[tuple[Any, ...]]:
        return [each for each in self.robot.told if each[0] in names]

    async def wait(self, seconds: float) -> None:
        """Time passes, in steps as the bridge looks."""
        for _ in range(round(seconds / 0.01)):
            self.clock.go_on(0.01)
            self.bridge.look()
        await settled()


@asynccontextmanager
async def opened() -> AsyncIterator[Hall]:
    hall = Hall()
    async with anyio.create_task_group() as tasks:
        await tasks.start(hall.bridge.run)
        yield hall
        tasks.cancel_scope.cancel()


async def test_a_page_is_told_what_robot_this_is_and_sees_it() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(place=A_PLACE)
        await settled()
        page.read()
        assert {each["kind"] for each in page.heard} == {
            "page",
            "hello",
            "world",
            "lessons",
            "health",
            "exam",
            "simulation",
            "state",
        }
        assert page.last("page") == {"kind": "page", "device": "phone", "robot": "127.0.0.1:5683", "seat": "here"}
        assert page.last("hello")["robot"] == "kurt2-indoor"
        assert page.last("lessons")["lessons"][0]["text"] == "RLA 1: forward"
        assert page.last("state")["place"]["x_m"] == A_PLACE.x_m


async def test_numbers_that_json_has_not_become_null() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(distance=float("inf"), infrared_age_s=float("inf"))
        state = page.last("state")
        assert (state["distance"], state["infrared_age_s"]) == (None, None)


async def test_one_page_drives_and_the_next_one_watches_until_it_takes_the_pad() -> None:
    async with opened() as hall:
        first, second = Page(hall), Page(hall)
        await first.see()
        await second.see(teacher="phone")
        assert second.last("page")["seat"] == "elsewhere"
        assert (await second.order("answer", action="forward", level="basic", beside=False))["why"] == "watching"
        second.press()
        assert second.last("let_go")["text"]
        assert hall.told("press", "answer") == []

        assert (await second.order("take"))["accepted"]
        assert second.last("page")["seat"] == "here"
        assert first.last("page")["seat"] == "elsewhere"
        assert hall.told("take") == []  # the robot knows this device as its teacher already
        second.press()
        assert hall.told("press") == [("press", 0.2, 0.2)]


async def test_taking_the_pad_of_a_page_that_drives_ends_its_press() -> None:
    async with opened() as hall:
        first, second = Page(hall), Page(hall)
        await first.see(teacher="phone")
        await second.see()
        first.press()
        await second.order("take")
        assert hall.told("let_go") == [("let_go",)]


async def test_taking_the_pad_takes_the_robot_where_this_device_does_not_teach_yet() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher=None)
        assert (await page.order("take"))["text"] == "take done"
        assert hall.told("take") == [("take",)]


async def test_every_page_may_stop_the_robot_also_without_a_picture() -> None:
    async with opened() as hall:
        driver, watcher = Page(hall), Page(hall)
        await driver.see(teacher="phone")
        driver.press()
        watcher.say(StopNow(5))
        await settled()
        assert watcher.last("answer")["accepted"]
        assert hall.told("stop") == [("stop",)]
        driver.press()  # the same press still comes: it is over
        assert hall.told("press") == [("press", 0.2, 0.2)]


async def test_the_robot_is_told_that_somebody_looks_while_heartbeats_come() -> None:
    async with opened() as hall:
        page = Page(hall)
        assert not hall.robot.watching
        await page.see()
        assert hall.robot.watching
        await hall.wait(0.29)
        assert hall.robot.watching
        await hall.wait(0.02)
        assert not hall.robot.watching


async def test_heartbeats_on_an_old_picture_do_not_count() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see()
        for _ in range(6):
            await hall.wait(0.1)
            page.beat()
        assert not hall.robot.watching  # the page lives, and has seen nothing for 0.6 s


async def test_a_page_that_only_watches_is_nobody_who_looks_after_the_robot() -> None:
    async with opened() as hall:
        driver, watcher = Page(hall), Page(hall)
        await driver.see()
        await hall.wait(0.4)
        await watcher.see()
        assert not hall.robot.watching


async def test_a_hidden_page_looks_at_nothing_and_holds_nothing() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher="phone")
        page.press()
        page.say(Hidden())
        await settled()
        assert not hall.robot.watching
        assert hall.told("let_go") == [("let_go",)]
        hall.robot.show()
        await settled()
        assert "state" not in {each["kind"] for each in page.read()}


async def test_a_page_not_heard_of_for_250_ms_lets_go_of_the_robot() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher="phone")
        page.press()
        await hall.wait(0.24)
        assert hall.robot.pressing
        await hall.wait(0.02)
        assert hall.told("let_go") == [("let_go",)]
        assert "250 ms" in page.last("let_go")["text"]


async def test_the_presses_that_come_after_a_stall_do_not_drive() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher="phone")
        page.press(hold=1)
        await hall.wait(0.5)
        for hold in (1, 1, 2, 3):  # a burst: all given on the picture of half a second ago
            page.press(hold=hold)
        assert hall.told("press") == [("press", 0.2, 0.2)]
        await page.see()
        page.press(hold=4)
        assert len(hall.told("press")) == 2


async def test_a_press_that_the_robot_ended_does_not_begin_again_by_itself() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher="phone")
        page.press(hold=1)
        hall.robot.pressing, hall.robot.refusal = False, local_refusal(RefusalCode.STOPPED_MEANWHILE, command="go")
        page.press(hold=1)
        assert page.last("let_go")["text"] == text_of(STOPPED, Surface.PAGE)
        page.press(hold=1)
        assert len(hall.told("press")) == 1
        page.press(hold=2)
        assert len(hall.told("press")) == 2


async def test_a_quick_release_ends_the_old_press_and_not_the_next_one() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher="phone")
        page.press(hold=1)
        page.say(Release())
        page.press(hold=2)  # came with the release
        await settled()
        page.press(hold=2)  # 50 ms later
        assert [each[0] for each in hall.told("press", "let_go")] == ["press", "let_go", "press"]
        assert hall.robot.pressing
        page.press(hold=2)
        assert len(hall.told("press")) == 3


DRIVING = {"teacher": "phone", "action": "forward", "phase": 1}


async def test_a_robot_that_drives_unseen_is_stopped_320_ms_after_the_last_heartbeat() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(**DRIVING)
        await hall.wait(0.29)
        assert hall.told("stop") == []
        await hall.wait(0.03)
        assert hall.told("stop") == [("stop",)]
        assert "nobody saw the robot" in page.last("let_go")["text"]
        await hall.wait(1.0)
        assert len(hall.told("stop")) == 1


@pytest.mark.parametrize(
    "how",
    [lambda page: page.say(Hidden()), lambda page: page.hall.bridge.leave(page.visitor)],
    ids=["hidden", "closed"],
)
async def test_hiding_or_closing_the_page_stops_a_robot_that_drives(how: Callable[[Page], None]) -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(**DRIVING)
        how(page)
        await settled()
        assert hall.told("stop") == [("stop",)]


@pytest.mark.parametrize("refuses", ["", "world: 'x' is not known"])
async def test_a_run_that_ends_for_the_next_one_is_not_taken_for_one_that_drives_unseen(refuses: str) -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(**DRIVING)
        hall.robot.refuses = refuses
        await page.order("next_run", world="b", task=None, fresh=False)
        hall.robot.refuses = ""
        page.say(Hidden())
        await settled()
        assert hall.told("stop") == ([("stop",)] if refuses else [])


async def test_a_robot_that_begins_to_drive_just_after_is_stopped_too() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(**{**DRIVING, "action": None})
        page.say(Hidden())
        await settled()
        assert hall.told("stop") == []
        hall.robot.show(action="forward")
        await settled()
        assert hall.told("stop") == [("stop",)]


@pytest.mark.parametrize("but", [{"phase": 5}, {"teacher": "anna"}, {"action": None}])
async def test_nobody_needs_to_look_at_a_robot_that_stands_or_drives_for_another(but: dict[str, object]) -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(**{**DRIVING, **but})
        await hall.wait(1.0)
        assert hall.told("stop") == []


async def test_the_pad_changes_pages_while_the_robot_drives() -> None:
    async with opened() as hall:
        first, second = Page(hall), Page(hall)
        await first.see(**DRIVING)
        await second.see()
        await second.order("take")
        second.beat()
        await hall.wait(0.1)
        assert hall.told("stop") == []
        assert hall.robot.watching
        await hall.wait(0.3)
        assert hall.told("stop") == [("stop",)]


@pytest.mark.parametrize("how", [lambda page: page.say(Release()), lambda page: page.hall.bridge.leave(page.visitor)])
async def test_letting_go_and_leaving_end_the_press(how: Callable[[Page], None]) -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher="phone")
        page.press()
        how(page)
        await settled()
        assert hall.told("let_go") == [("let_go",)]


async def test_the_end_of_the_program_lets_go_only_of_what_it_holds() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(teacher="phone")
        await hall.bridge.end()
        assert hall.told("let_go") == []
        page.press()
        await hall.bridge.end()
        assert hall.told("let_go") == [("let_go",)]
        assert not hall.robot.watching


async def test_an_order_means_the_picture_that_the_page_showed() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(tick=500)
        shown = page.picture
        await page.see(tick=600)
        page.picture = shown
        await page.order("correct", action="spin_left", level="basic")
        await page.order("reward", value=-1)
        await page.order("appraise", appraisal="bad")
        assert hall.told("correct", "reward", "appraise") == [
            ("correct", "spin_left", 500),
            ("reward", -1, 500),
            ("appraise", "bad", 500),
        ]


async def test_an_order_on_no_picture_or_on_one_of_an_earlier_robot_is_not_sent() -> None:
    async with opened() as hall:
        page = Page(hall)
        page.beat()
        assert (await page.order("answer", action="forward", level="basic", beside=False))["why"] == "stale"
        await page.see(boot=b"old!")
        hall.robot.show(boot=b"new!")
        await settled()
        assert (await page.order("answer", action="forward", level="basic", beside=False))["why"] == "stale"
        assert hall.told("answer") == []


MOVING: list[tuple[str, dict[str, object]]] = [
    ("resume", {}),
    ("take", {}),
    ("phase", {"phase": Phase.AUTONOMOUS}),
    ("place", {"x_m": 1.0, "y_m": 2.0, "heading_rad": 0.5}),
    ("pursue", {"behaviour": "turn_left"}),
]
OTHERS: list[tuple[str, dict[str, object]]] = [
    ("correct", {"action": "forward", "level": "basic"}),
    ("appraise", {"appraisal": "bad"}),
    ("phase", {"phase": Phase.CRITIC}),
    ("hand_over", {"to": None}),
]


@pytest.mark.parametrize(
    ("name", "arguments", "longest_s"), [(*each, 1.0) for each in MOVING] + [(*each, 3.0) for each in OTHERS]
)
async def test_an_order_that_was_long_on_its_way_is_refused(
    name: str, arguments: dict[str, object], longest_s: float
) -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see()
        hall.clock.go_on(longest_s - 0.01)
        assert (await page.order(name, **arguments))["accepted"]
        told = len(hall.told(*NAMES))
        hall.clock.go_on(0.02)
        answer = await page.order(name, **arguments)
        assert (answer["why"], answer["text"]) == ("stale", STALE)
        assert len(hall.told(*NAMES)) == told


async def test_an_old_take_does_not_take_the_pad_either() -> None:
    async with opened() as hall:
        first, second = Page(hall), Page(hall)
        await first.see(teacher="phone")
        await second.see()
        hall.clock.go_on(1.1)
        assert (await second.order("take"))["why"] == "stale"
        assert second.last("page")["seat"] == "elsewhere"


async def test_a_go_on_a_picture_from_before_a_stop_is_refused() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(stopped=ActiveStop(StopReason.SAID_STOP, "phone"))
        shown = page.picture
        hall.clock.go_on(0.1)
        await page.see(stopped=ActiveStop(StopReason.SAID_STOP, "anna"))
        page.picture = shown
        assert (await page.order("resume"))["why"] == "stopped"
        hall.clock.go_on(0.1)
        await page.see()
        hall.clock.go_on(0.1)
        page.say(StopNow(7))
        await page.order("resume")
        assert hall.told("resume") == []
        await page.see()
        assert (await page.order("resume"))["accepted"]


async def test_a_list_of_lessons_says_which_orders_it_knows_of() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see()
        answer = await page.order("answer", action="forward", level="basic", beside=False)
        with anyio.fail_after(5):
            while page.last("lessons")["after"] < answer["done"]:
                await settled()
                await anyio.sleep(0.01)


ORDERS: list[tuple[str, dict[str, object], tuple[Any, ...]]] = [
    ("answer", {"action": "forward", "level": "basic", "beside": False}, ("answer", "forward", 102)),
    ("answer", {"action": "turn_left", "level": "mid", "beside": True}, ("answer", "turn_left", 102, "mid", True)),
    ("correct", {"action": "turn_left", "level": "mid"}, ("correct", "turn_left", 102, "mid")),
    ("undo", {"lesson": "phone-0a"}, ("undo", "phone-0a")),
    ("phase", {"phase": Phase.CORRECTIONS}, ("set_phase", Phase.CORRECTIONS)),
    ("pursue", {"behaviour": "turn_left"}, ("pursue", "turn_left")),
    ("name", {"name": "door"}, ("name_situation", "door", 102)),
    ("seek", {"name": "door"}, ("seek", "door")),
    ("stop_seeking", {}, ("stop_seeking",)),
    ("be_at", {"name": "door"}, ("be_at", "door")),
    ("begin_session", {"name": "morning"}, ("begin_session", "morning")),
    ("end_session", {}, ("end_session",)),
    ("resume", {}, ("resume",)),
    ("hand_over", {"to": "anna"}, ("hand_over", "anna")),
    ("save", {"label": ""}, ("save", "")),
    ("export", {}, ("export", "package")),
    ("examine", {}, ("examine",)),
    ("load", {"upload": bytes(8), "sha256": b"\xab" * 32}, ("load", bytes(8), b"\xab" * 32)),
    ("speed", {"times": 5}, ("set_speed", 5)),
    ("put_back", {}, ("put_back",)),
    ("next_run", {"world": "b", "task": None, "fresh": False}, ("next_run", "b", None, False)),
    ("examine", {}, ("examine",)),
    ("put_back", {}, ("put_back",)),
    ("next_run", {"world": "b", "task": None, "fresh": False}, ("next_run", "b", None, False)),
    ("move", {"name": "tongue", "dx_m": 0.1, "dy_m": -0.2}, ("move_wall", "tongue", 0.1, -0.2)),
    ("place", {"x_m": 1.0, "y_m": 2.0, "heading_rad": 0.5}, ("place", 1.0, 2.0, 0.5)),
]


@pytest.mark.parametrize(("name", "arguments", "told"), ORDERS)
async def test_orders_reach_the_robot(name: str, arguments: dict[str, object], told: tuple[Any, ...]) -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see(tick=102)
        answer = await page.order(name, **arguments)
        assert answer["accepted"]
        assert told in hall.robot.told


async def test_a_refusal_and_a_robot_that_is_silent_are_said() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see()
        hall.robot.refuses = "anna teaches now"
        assert (await page.order("resume"))["text"] == "anna teaches now"
        hall.robot.silent = True
        assert (await page.order("resume"))["why"] == "unknown"
        page.press()
        page.say(Release())
        await settled()
        assert "did not answer" in page.last("let_go")["text"]


async def test_a_page_has_only_so_many_orders_under_way_but_can_always_stop() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see()
        never = anyio.Event()

        async def wait_for_ever() -> Any:
            await never.wait()

        hall.robot.resume = wait_for_ever  # type: ignore[method-assign]
        for _ in range(8):
            page.say(PageOrder(1, "resume", {}, page.picture))
            await settled()
        assert (await page.order("resume"))["why"] == "busy"
        page.say(StopNow(2))
        await settled()
        assert hall.told("stop") == [("stop",)]


async def test_a_robot_that_is_not_there_is_said_where_it_was_looked_for() -> None:
    async with opened() as hall:
        page = Page(hall)
        await hall.wait(0.1)
        assert page.last("silent")["text"] == "no robot at 127.0.0.1:5683; is kurt2rt run running?"
        await page.see()
        hall.robot.state_age_s = 0.6
        hall.robot.trouble = "connection refused"
        await hall.wait(0.6)
        assert page.last("silent")["text"] == "nothing heard of the robot at 127.0.0.1:5683 (connection refused)"


async def test_a_robot_that_was_started_anew_introduces_itself_again() -> None:
    async with opened() as hall:
        page = Page(hall)
        await page.see()
        before = len(hall.told("hello"))
        await page.see(boot=b"new!")
        with anyio.fail_after(5):
            while len(hall.told("hello")) == before:
                await settled()
                await anyio.sleep(0.01)
