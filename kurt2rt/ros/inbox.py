"""Queue of one topic's messages, from zenoh's thread to the thread of the tick."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import Generic, NamedTuple, Protocol, TypeVar

from hal.sender_clock import SenderClock
from kurt2rt.ros.messages import InvalidMessageError, Message, MessageT, Time, decode, to_seconds
from kurt2rt.ros.port import RosPort
from kurt2rt.ros.topic import Topic

_MOST_WAITING = 16
_MOST_BYTES = 100_000
"""Longer than a scan of 12 000 rays; more would cost the tick milliseconds."""
ResultT = TypeVar("ResultT")


DRIFT = 0.0005
"""Largest drift of two clocks that nothing keeps together, 0.5 ms a second; quartzes drift by a tenth of it."""
_SLACK_S = 0.1
"""Jitter of a wireless network; a third of what `stale_encoder_s` allows."""


class StampedAge:
    """Ages of one topic's messages. A message never counts as younger than its time since arrival."""

    def __init__(self, now_s: float, wall_s: float) -> None:
        """Start without a message, at a moment that both clocks of this machine give; senders stamp by wall clocks."""
        self.clock = SenderClock(DRIFT, _SLACK_S, agreed_offset_s=now_s - wall_s)

    def on_arrival(self, message: Message, arrival_s: float) -> float | None:
        """Return a message's age at its arrival, in s, 0 if its sender stamps nothing.

        None: its stamp does not go on from those before. `arrival_s`: on this machine's monotonic clock.
        """
        stamp = getattr(getattr(message, "header", None), "stamp", None)
        stamp_s = to_seconds(stamp) if isinstance(stamp, Time) else 0.0
        return self.clock.age_s(stamp_s, arrival_s) if stamp_s > 0 else 0.0


class Clock(Protocol):
    """Clocks by which messages are dated: monotonic for ages, and wall time for stamps."""

    def now_s(self) -> float:
        """Return the present in s, from any start, never backwards."""
        ...

    def wall_s(self) -> float:
        """Return the present in s since 1970, as time stamps count it."""
        ...


class MachineClock:
    """Clocks of this machine, in s: monotonic, and wall clock since 1970; a simulation has its own."""

    now_s = staticmethod(time.monotonic)
    wall_s = staticmethod(time.time)


class _Waiting(NamedTuple):
    payload: bytes
    arrived_s: float


class Inbox(Generic[MessageT]):
    """Messages of one topic that arrived. The oldest of too many are dropped; bytes that are no message are junk."""

    def __init__(
        self, port: RosPort, topic: Topic, kind: type[MessageT], clock: Clock, *, one_sender: bool = False
    ) -> None:
        """Subscribe to the topic, whose messages are of class `kind`. Raises RosConnectionError.

        `one_sender`: all messages are of one sender, so their stamps go on and tell their ages; others are junk.
        """
        self._topic, self._kind, self._clock = topic, kind, clock
        self._one_sender = one_sender
        self._waiting: deque[_Waiting] = deque(maxlen=_MOST_WAITING)
        self.junk = 0
        """Messages so far that could not be read."""
        self.forget_clock()
        port.subscribe(topic, self._keep)

    @property
    def jumps(self) -> int:
        """Number of times that the sender's clock was set."""
        return self._age.clock.jumps if self._age else 0

    @property
    def notice(self) -> str:
        """Trouble with the stamps, for the user, such as `scan: its clock was set by +2.0 s`; empty without any."""
        told = self._age.clock.notice(self._clock.now_s()) if self._age else ""
        return f"{self._topic.name}: {told}" if told else ""

    def forget_clock(self) -> None:
        """Count the next message as the first of its sender, which may have been away."""
        clock = self._clock
        self._age = StampedAge(clock.now_s(), clock.wall_s()) if self._one_sender else None

    def take(self, read: Callable[[MessageT, float], ResultT | None]) -> Iterator[ResultT]:
        """Return what `read` makes of each message that waits, oldest first, and of its age in s.

        A message for which it raises kurt2rt.ros.messages.InvalidMessageError, or returns None, is junk as well.
        """
        return self._read(read) if self._waiting else iter(())  # most ticks find none

    def _read(self, read: Callable[[MessageT, float], ResultT | None]) -> Iterator[ResultT]:
        for _ in range(len(self._waiting)):
            payload, arrived_s = self._waiting.popleft()
            try:
                message = decode(payload, self._kind)
                aged_s = self._age.on_arrival(message, arrived_s) if self._age else 0.0
                result = None if aged_s is None else read(message, self._clock.now_s() - arrived_s + aged_s)
            except InvalidMessageError:
                result = None
            if result is None:
                self.junk += 1
            else:
                yield result

    def _keep(self, payload: bytes) -> None:
        if len(payload) > _MOST_BYTES:
            self.junk += 1
            return
        # A deque drops the oldest by itself, and is safe between two threads.
        self._waiting.append(_Waiting(payload, self._clock.now_s()))
