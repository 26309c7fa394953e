"""A robot that drives, and the page that its teacher has open on a phone."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from anyio.from_thread import BlockingPortal, start_blocking_portal

from tests.page.fake_robot import A_PLACE, FakeRobot
from tests.page.phone import PORTRAIT, Phone
from tests.page.test_browser import show_on
from tests.page.test_served_page import TOKEN, served


class Lesson:
    """A robot, and the page that its teacher has open."""

    def __init__(self, phone: Phone, portal: BlockingPortal, robot: FakeRobot) -> None:
        self.phone = phone
        self.robot = robot
        self._portal = portal

    def show(self, **changes: object) -> None:
        """From the next picture on."""
        self._portal.call(partial(self.robot.show, **changes))

    def reads(self, selector: str, text: str) -> None:
        """Wait until it stands there."""
        self.phone.wait(lambda: text in self.phone.text(selector), f"{selector} says {text!r}")

    def told(self, name: str) -> list[object]:
        """What the robot was told of one kind."""
        return [each[1] for each in self.robot.told if each[0] == name]


@contextmanager
def a_lesson(phone: Phone, prepare: Callable[[FakeRobot], None], **shown: object) -> Iterator[Lesson]:
    """The robot drives by its RLA 1, shows a picture each 50 ms, and the page is open; `prepare` comes first."""
    with start_blocking_portal() as portal, portal.wrap_async_context_manager(served()) as page:
        prepare(page.robot)
        lesson = Lesson(phone, portal, page.robot)
        lesson.show(teacher="local", place=A_PLACE, **shown)
        pictures = portal.start_task_soon(show_on, page.robot)
        try:
            phone.turn(PORTRAIT)
            phone.open(f"http://127.0.0.1:{page.port}/pair?token={TOKEN}")
            lesson.reads("#sentence", "RLA 1 does forward")
            yield lesson
        finally:
            pictures.cancel()
