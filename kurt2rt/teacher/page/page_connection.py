"""One open page, as the server knows it."""

import json
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

import anyio

from kurt2rt.teacher.page.deadman_switch import DeadmanSwitch
from kurt2rt.teacher.page.sent_states import SentStates

_MOST_WAITING = 64


class PageConnection:
    """What goes to the page. Of the robot's state only the newest waits, of everything else only so much."""

    def __init__(self, number: int) -> None:
        self.number = number
        self.grip = DeadmanSwitch()
        self.pictures = SentStates()
        self.visible = False
        self.lost = False
        """So far behind that it has to begin anew."""
        self.beat: tuple[float, float] | None = None
        """The page's clock at its last heartbeat, in ms, and ours when it came, in s."""
        self.orders = 0
        """Orders that the robot has not answered yet."""
        self._waiting: OrderedDict[object, Mapping[str, Any]] = OrderedDict()
        self._state: tuple[bytes, Mapping[str, Any]] | None = None
        self._wake = anyio.Event()

    def show(self, boot: bytes, state: Mapping[str, Any]) -> None:
        """The newest picture of the robot, from this start of the robot program."""
        self._state = (boot, state)
        self.look()

    def tell(self, message: Mapping[str, Any], *, about: object = None) -> None:
        """A message; one that still waits `about` the same thing is replaced by it."""
        key = object() if about is None else about
        if key not in self._waiting and len(self._waiting) >= _MOST_WAITING:
            self.lost = True
        else:
            self._waiting[key] = message
        self.look()

    def look(self) -> None:
        """Something has changed that may let a message go."""
        self._wake.set()

    async def next(self) -> None:
        """Wait until there may be something to send."""
        await self._wake.wait()
        self._wake = anyio.Event()

    def take(self, now_s: float) -> str | None:
        """The next message, as JSON; None when there is none now."""
        if self._waiting:
            _, message = self._waiting.popitem(last=False)
            return json.dumps(message, separators=(",", ":"), allow_nan=False)
        if self._state is None or not self.visible or not self.pictures.may_send:
            return None
        boot, state = self._state
        self._state = None
        echo = None if self.beat is None else [self.beat[0], round((now_s - self.beat[1]) * 1000, 1)]
        number = self.pictures.send(boot, state["tick"], now_s)
        return json.dumps({**state, "picture": number, "echo": echo}, separators=(",", ":"), allow_nan=False)
