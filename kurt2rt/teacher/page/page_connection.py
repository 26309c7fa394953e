"""Connection of one open page."""

import json
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import anyio


@dataclass(frozen=True, slots=True)
class SentState:
    """State that was sent to a page, by which a message of the page is dated."""

    boot: bytes
    tick: int
    sent_s: float


class SentStates:
    """Numbered states, so that a message of the page can name the state on its screen.

    A page that does not acknowledge its states gets no more: they would age in TCP's buffers.
    """

    def __init__(self, window: int = 8, history: int = 128) -> None:
        """Allow `window` states without acknowledgement; the last `history` states can be named."""
        self._window = window
        self._history = history
        self._sent: OrderedDict[int, SentState] = OrderedDict()
        self._newest = 0
        self._acknowledged = 0

    @property
    def may_send(self) -> bool:
        """True while the page keeps up."""
        return self._newest - self._acknowledged < self._window

    def add(self, boot: bytes, tick: int, now_s: float) -> int:
        """Add a state that is sent now; return its number."""
        self._newest += 1
        self._sent[self._newest] = SentState(boot, tick, now_s)
        if len(self._sent) > self._history:
            self._sent.popitem(last=False)
        return self._newest

    def acknowledge(self, number: int) -> None:
        """Note that the page shows the state of a number."""
        if self._acknowledged < number <= self._newest:
            self._acknowledged = number

    def get(self, number: int | None) -> SentState | None:
        """Return a state by its number; None if it was never sent, or too long ago."""
        return None if number is None else self._sent.get(number)

    def age_s(self, number: int | None, now_s: float) -> float:
        """Return the time since a state was sent, in s; infinite for a state that `get` does not know."""
        state = self.get(number)
        return float("inf") if state is None else now_s - state.sent_s


_MAX_WAITING = 64


class DeadmanSwitch:
    """Deadman switch: the robot drives while a press is held, and stops when it ends.

    A press ends by release, or 0.25 s without a message, and never starts again: driving needs a new press id.

    TCP may deliver late messages in a burst, so a message counts by the age of the state that the page showed, not by
    its arrival. Times are seconds of a monotonic clock.
    """

    def __init__(self, lease_s: float = 0.25, max_state_age_s: float = 0.4) -> None:
        """Start open; a message holds for `lease_s`, at most until `max_state_age_s` after its state was sent."""
        self._lease_s = lease_s
        self._max_state_age_s = max_state_age_s
        self._press_id: int | None = None
        self._ended = 0
        self._until_s = 0.0

    @property
    def held(self) -> bool:
        """True while a press drives."""
        return self._press_id is not None

    def is_held_by(self, press_id: int) -> bool:
        """Return whether this press drives."""
        return self._press_id == press_id

    def press(self, press_id: int, state_age_s: float, now_s: float) -> bool:
        """Begin or renew a press at `now_s`; return False if the message does not count. Press ids grow.

        A message does not count on a state older than the limit (`state_age_s`, in s), or for a press that ended.
        """
        if press_id <= self._ended or state_age_s >= self._max_state_age_s:
            return False
        if self._press_id != press_id:
            # A larger id ends all presses before it.
            self._ended = press_id - 1
            self._press_id = press_id
            self._until_s = now_s
        self._until_s = max(self._until_s, now_s + min(self._lease_s, self._max_state_age_s - state_age_s))
        return True

    def release(self) -> None:
        """End the press; its id never drives again."""
        if self._press_id is not None:
            self._ended = self._press_id
            self._press_id = None

    def expired(self, now_s: float) -> bool:
        """Return whether the press that drives was not renewed in time."""
        return self._press_id is not None and now_s >= self._until_s


class PageConnection:
    """State of one open page, and its outgoing messages: the newest state, and a bounded queue of others."""

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
