"""Connection of one open page."""

import json
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

import anyio

from kurt2rt.teacher.page.deadman_switch import DeadmanSwitch
from kurt2rt.teacher.page.sent_states import SentStates

_MAX_WAITING = 64


class PageConnection:
    """Outgoing messages of one page: the newest state of the robot, and a bounded queue of other messages."""

    def __init__(self, number: int) -> None:
        self.number = number
        self.deadman = DeadmanSwitch()
        self.states = SentStates()
        self.visible = False
        self.lost = False
        """The page is too far behind: it has to connect again."""
        self.heartbeat: tuple[float, float] | None = None
        """Last heartbeat: the page's clock in ms, and this machine's at its arrival in s."""
        self.pending = 0
        """Number of commands without an answer of the robot."""
        self._waiting: OrderedDict[object, Mapping[str, Any]] = OrderedDict()
        self._state: tuple[bytes, Mapping[str, Any]] | None = None
        self._wakeup = anyio.Event()

    def set_state(self, boot: bytes, state: Mapping[str, Any]) -> None:
        """Replace the state that waits; `boot` identifies the start of the robot program."""
        self._state = (boot, state)
        self.wake()

    def send(self, message: Mapping[str, Any], *, topic: object = None) -> None:
        """Queue a message; it replaces one of the same topic that still waits."""
        key = object() if topic is None else topic
        if key not in self._waiting and len(self._waiting) >= _MAX_WAITING:
            self.lost = True
        else:
            self._waiting[key] = message
        self.wake()

    def wake(self) -> None:
        """Wake the task that waits in `wait`, to look for messages to send."""
        self._wakeup.set()

    async def wait(self) -> None:
        """Wait until a message or a state was queued, or `wake` was called; then `pop` may have one."""
        await self._wakeup.wait()
        self._wakeup = anyio.Event()

    def pop(self, now_s: float) -> str | None:
        """Return the next message as JSON; None if there is none now."""
        if self._waiting:
            _, message = self._waiting.popitem(last=False)
            return json.dumps(message, separators=(",", ":"), allow_nan=False)
        if self._state is None or not self.visible or not self.states.may_send:
            return None
        boot, state = self._state
        self._state = None
        echo = None if self.heartbeat is None else [self.heartbeat[0], round((now_s - self.heartbeat[1]) * 1000, 1)]
        number = self.states.add(boot, state["tick"], now_s)
        return json.dumps({**state, "picture": number, "echo": echo}, separators=(",", ":"), allow_nan=False)
