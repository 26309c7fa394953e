"""A robot that drives, and the page that its teacher has open on a phone."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import anyio
import pytest
from anyio.from_thread import BlockingPortal

from kurt2rt.channel.protocol.state import State
from kurt2rt.teacher.page.cached_resources import CachedResource
from tests.teacher.page.fake_robot import A_PLACE, FakeRobot
from tests.teacher.page.page_time import PageTime, stepped_portal
from tests.teacher.page.phone import PORTRAIT, Phone
from tests.teacher.page.test_served_page import TOKEN, Served, served

_INTRODUCED = "return document.querySelector('#robot-name')?.textContent ?? '';"
_SHOWN = """
const [clock, claim] = ['#clock', '#claim'].map((each) => document.querySelector(each));
return [clock.textContent, claim.hidden];
"""
_PAUSE_S = 0.01
"""Pause of the server after a request for a resource: each lesson begins with those of another robot."""


class Lesson:
    """A robot, and the page that its teacher has open."""

    def __init__(self, phone: Phone, portal: BlockingPortal, time: PageTime, page: Served) -> None:
        self.phone = phone
        self._time = time
        self.robot = page.robot
        self._portal = portal
        self._address = f"http://127.0.0.1:{page.port}/pair?token={TOKEN}"
        self._begun = 0

    def begin(self, robot: Mapping[str, object] | None = None, **shown: object) -> Phone:
        """Start another robot, which drives by its RLA 1; close what the page has open from the robot before.

        `robot` are fields of FakeRobot, `shown` those of its first state; return the phone that shows it.

        The page stays loaded and is introduced to the new robot, because to load it takes far longer.
        """
        self._begun += 1
        self.phone.time = self._time
        boot, name = f"boot {self._begun}".encode(), f"robot {self._begun}"
        self._portal.call(self.robot.reset)
        for field, value in (robot or {}).items():
            setattr(self.robot, field, value)
        self.robot.greeting = replace(self.robot.greeting, boot=boot, robot=name)
        self.show(**{"boot": boot, "teacher": "local", "place": A_PLACE, **shown})
        self.phone.turn(PORTRAIT)
        self.phone.come_to(self._address)
        self.phone.wait(lambda: str(self.phone.run(_INTRODUCED)).startswith(f"{name},"), "it has introduced itself")
        # Its first pictures may have come before it did, and were shown as those of the robot before.
        self.show(clock_s=60.0 * self._begun)
        self.phone.wait(self._is_shown, "the page shows this robot, and is its teacher's")
        return self.phone

    def show(self, **changes: object) -> State:
        """Send a changed state; return it."""
        return self._portal.call(partial(self.robot.show, **changes))

    def reads(self, selector: str, text: str) -> None:
        """Wait until an element has a text."""
        self.phone.wait(lambda: text in self.phone.text(selector), f"{selector} says {text!r}")

    def reaches(self, clock: str) -> None:
        """Wait until the page has a state whose clock it shows as `clock`."""
        self.phone.wait(lambda: self.phone.run(_SHOWN)[0] == clock, f"the state of {clock}")

    def told(self, name: str) -> list[object]:
        """Return the first argument of each call of the robot."""
        return [each[1] for each in self.robot.told if each[0] == name]

    def _is_shown(self) -> bool:
        clock, in_charge = self.phone.run(_SHOWN)
        return bool(clock == f"{self._begun}:00" and in_charge)


async def show_on(robot: FakeRobot) -> None:
    """Send a state each 100 ms."""
    while True:
        await anyio.sleep(0.1)
        if robot.state is not None:
            robot.show()


@contextmanager
def lessons(phone: Phone) -> Iterator[Lesson]:
    """Serve a page and a robot, for one lesson after another."""
    quick = partial(CachedResource, pause_s=_PAUSE_S)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("kurt2rt.teacher.page.cached_resources.CachedResource", quick)
        with (
            stepped_portal() as (portal, time),
            portal.wrap_async_context_manager(served()) as page,
            time.shown_on(phone),
        ):
            pictures = portal.start_task_soon(show_on, page.robot)
            yield Lesson(phone, portal, time, page)
            pictures.cancel()
