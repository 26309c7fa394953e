"""Queue of one topic's messages, from zenoh's thread to the thread of the tick."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import Generic, NamedTuple, Protocol, TypeVar

from kurt2rt.ros.message_age import StampedAge
from kurt2rt.ros.messages import InvalidMessageError, MessageT, Time, decode, to_seconds
from kurt2rt.ros.port import RosPort
from kurt2rt.ros.topic import Topic

_MOST_WAITING = 16
_MOST_BYTES = 100_000
"""Longer than a scan of 12 000 rays; more would cost the tick milliseconds."""
ResultT = TypeVar("ResultT")


class Clock(Protocol):
    """Clocks of this machine."""

    def now_s(self) -> float:
        """Return the present in s, from any start, never backwards."""
        ...

    def wall_s(self) -> float:
        """Return the present in s since 1970, as time stamps count it."""
        ...


class MachineClock:
    """The clocks of this machine themselves."""

    now_s = staticmethod(time.monotonic)
    wall_s = staticmethod(time.time)


class _Waiting(NamedTuple):
    payload: bytes
    now_s: float
    wall_s: float


class Inbox(Generic[MessageT]):
    """Messages of one topic that arrived. The oldest of too many are dropped; bytes that are no message are junk."""

    def __init__(self, port: RosPort, topic: Topic, kind: type[MessageT], clock: Clock) -> None:
        """Subscribe to the topic, whose messages are of class `kind`. Raises RosConnectionError."""
        self._kind, self._clock, self._age = kind, clock, StampedAge()
        self._waiting: deque[_Waiting] = deque(maxlen=_MOST_WAITING)
        self.junk = 0
        """Messages so far that could not be read."""
        port.subscribe(topic, self._keep)

    def take(self, read: Callable[[MessageT, float], ResultT]) -> Iterator[ResultT]:
        """Return what `read` makes of each message that waits, oldest first, and of its age in s.

        A message for which it raises kurt2rt.ros.messages.InvalidMessageError is junk as well.
        """
        return self._read(read) if self._waiting else iter(())  # most ticks find none

    def _read(self, read: Callable[[MessageT, float], ResultT]) -> Iterator[ResultT]:
        for _ in range(len(self._waiting)):
            payload, arrived_s, wall_s = self._waiting.popleft()
            try:
                message = decode(payload, self._kind)
                stamp = getattr(getattr(message, "header", None), "stamp", None)
                stamped_s = to_seconds(stamp) if isinstance(stamp, Time) else 0.0
                age_s = self._clock.now_s() - arrived_s + self._age.on_arrival(stamped_s, wall_s)
                result = read(message, age_s)
            except InvalidMessageError:
                self.junk += 1
            else:
                yield result

    def _keep(self, payload: bytes) -> None:
        if len(payload) > _MOST_BYTES:
            self.junk += 1
            return
        # A deque drops the oldest by itself, and is safe between two threads.
        self._waiting.append(_Waiting(payload, self._clock.now_s(), self._clock.wall_s()))
