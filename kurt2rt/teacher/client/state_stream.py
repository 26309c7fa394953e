"""The pictures of the robot as they come to a teacher's device, and the ticks that its answers tell."""

import math
from collections import deque
from collections.abc import AsyncIterator, Callable

import anyio

from kurt2rt.channel.protocol.state import State

_RATE_OVER_S = 1.0


class StateStream:
    """Keeps the newest one and wakes whoever waits for it; nothing queues."""

    def __init__(self, now: Callable[[], float]) -> None:
        """`now` is a monotonic clock in seconds."""
        self.newest: State | None = None
        self.count = 0
        """How many came."""
        self.restarts = 0
        """How often the robot program was found started anew."""
        self._now = now
        self._came_s: deque[float] = deque(maxlen=100)
        self._heard_tick = -1
        self._stopped_tick = -1
        self._closed = False
        self._news = anyio.Event()

    @property
    def age_s(self) -> float:
        """How long ago the newest one came; infinite before the first."""
        return self._now() - self._came_s[-1] if self._came_s else math.inf

    @property
    def per_s(self) -> float:
        """How many came in the last second."""
        since_s = self._now() - _RATE_OVER_S
        return sum(came_s > since_s for came_s in self._came_s) / _RATE_OVER_S

    @property
    def heard_tick(self) -> int:
        """Newest tick of the robot's present start that was heard of; answers come more often than pictures."""
        return max(self._heard_tick, self.looked_tick)

    @property
    def looked_tick(self) -> int:
        """Newest tick that the teacher knows the robot of: of a picture, or of the stop that he said himself.

        Other answers do not count here: they do not tell that somebody else has stopped the robot meanwhile.
        """
        return max(self._stopped_tick, -1 if self.newest is None else self.newest.tick)

    def hear(self, boot: bytes, tick: int, *, stopped: bool = False) -> None:
        """The robot, in the start that `boot` names, told its tick in an answer; `stopped`: to a stop."""
        if self.newest is None or boot != self.newest.boot:
            return
        self._heard_tick = max(self._heard_tick, tick)
        if stopped:
            self._stopped_tick = max(self._stopped_tick, tick)

    def show(self, picture: State) -> None:
        """One more came; an older one than the newest of the same start of the robot is left out."""
        if self.newest is not None:
            if picture.boot != self.newest.boot:
                self.restarts += 1
                self._heard_tick = self._stopped_tick = -1
            elif picture.tick < self.newest.tick:
                return
        self.newest = picture
        self.count += 1
        self._came_s.append(self._now())
        self._wake()

    def close(self) -> None:
        """No more come: whoever waits is told."""
        self._closed = True
        self._wake()

    async def first(self) -> State | None:
        """The newest one, or the first where none came yet; None when no more come."""
        while self.newest is None and not self._closed:
            await self._news.wait()
        return self.newest

    async def states(self) -> AsyncIterator[State]:
        """The newest one and each that comes later, until no more come; who is slow misses those between."""
        seen = 0
        while not self._closed:
            if self.newest is None or self.count == seen:
                await self._news.wait()
                continue
            seen = self.count
            yield self.newest

    def _wake(self) -> None:
        self._news.set()
        self._news = anyio.Event()
