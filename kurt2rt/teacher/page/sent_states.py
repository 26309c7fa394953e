"""The pictures that one page was sent."""

from collections import OrderedDict
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SentState:
    """What a page shows: one state of the robot."""

    boot: bytes
    tick: int
    sent_s: float


class SentStates:
    """Numbers them, so that what a page says can name the picture it was said on.

    A page that does not answer for its pictures gets no more of them: they would wait in TCP's buffers and be old.
    """

    def __init__(self, window: int = 8, kept: int = 128) -> None:
        """At most `window` unanswered ones are on their way; the last `kept` can still be named."""
        self._window = window
        self._kept = kept
        self._sent: OrderedDict[int, SentState] = OrderedDict()
        self._newest = 0
        self._seen = 0

    @property
    def may_send(self) -> bool:
        """Whether the page keeps up."""
        return self._newest - self._seen < self._window

    def send(self, boot: bytes, tick: int, now_s: float) -> int:
        """Note a picture as sent; its number."""
        self._newest += 1
        self._sent[self._newest] = SentState(boot, tick, now_s)
        if len(self._sent) > self._kept:
            self._sent.popitem(last=False)
        return self._newest

    def see(self, number: int) -> None:
        """The page has this one on its screen."""
        if self._seen < number <= self._newest:
            self._seen = number

    def get(self, number: int | None) -> SentState | None:
        """A picture by its number; None for one that was never sent, or too long ago."""
        return None if number is None else self._sent.get(number)

    def age_s(self, number: int | None, now_s: float) -> float:
        """How long ago a picture was sent; infinite for one that cannot be named."""
        picture = self.get(number)
        return float("inf") if picture is None else now_s - picture.sent_s
