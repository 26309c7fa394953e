"""States that were sent to one page, by number."""

from collections import OrderedDict
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SentState:
    """One state of the robot, as it was sent to a page."""

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
