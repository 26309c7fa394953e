"""States of the robot as they come to a teacher's device, and the ticks in its answers."""

import math
from collections import deque
from collections.abc import AsyncIterator, Callable

import anyio

from kurt2rt.channel.protocol.state import State

_RATE_OVER_S = 1.0
_DRIVING_STATES = 2400
"""States of a driving robot that are kept: twice as many as come in the minute of driving that it remembers."""


class StateStream:
    """Newest state of the robot, with an event for the tasks that wait for it; nothing queues."""

    def __init__(self, now: Callable[[], float]) -> None:
        """`now` is a monotonic clock in seconds."""
        self.newest: State | None = None
        self.count = 0
        """Number of states that came."""
        self.restarts = 0
        """Number of restarts of the robot program that were seen."""
        self._drove: deque[tuple[int, int]] = deque(maxlen=_DRIVING_STATES)
        """Tick of each state of the present start that showed turning wheels, with the ticks driven until then."""
        self._now = now
        self._came_s: deque[float] = deque(maxlen=100)
        self._answered_tick = -1
        self._stopped_tick = -1
        self._closed = False
        self._changed = anyio.Event()

    @property
    def age_s(self) -> float:
        """Seconds since the newest state came; infinite before the first."""
        return self._now() - self._came_s[-1] if self._came_s else math.inf

    @property
    def per_s(self) -> float:
        """Number of states in the last second."""
        since_s = self._now() - _RATE_OVER_S
        return sum(came_s > since_s for came_s in self._came_s) / _RATE_OVER_S

    @property
    def newest_tick(self) -> int:
        """Newest tick of the robot's present start, of a state or an answer; answers come more often."""
        return max(self._answered_tick, self.displayed_tick)

    @property
    def displayed_tick(self) -> int:
        """Newest tick whose state the teacher knows: of a state, or of this device's own stop.

        Other answers do not count: they do not show that another teacher stopped the robot meanwhile.
        """
        return max(self._stopped_tick, -1 if self.newest is None else self.newest.tick)

    def on_answer(self, boot: bytes, tick: int, *, stopped: bool = False) -> None:
        """Note the tick of an answer, before which no state shows its effect.

        Args:
            boot: Start of the robot program that answered.
            tick: Its tick.
            stopped: Whether it carried out a stop.
        """
        if self.newest is None or boot != self.newest.boot:
            return
        self._answered_tick = max(self._answered_tick, tick)
        if stopped:
            self._stopped_tick = max(self._stopped_tick, tick)

    def publish(self, state: State) -> None:
        """Replace the newest state and wake its readers; drop a state older than the newest of the same start."""
        if self.newest is not None:
            if state.boot != self.newest.boot:
                self.restarts += 1
                self._answered_tick = self._stopped_tick = -1
                self._drove.clear()
            elif state.tick < self.newest.tick:
                return
        before, self.newest = self.newest, state
        if _turns(state):
            # A gap between two states counts in full if a wheel turned at either end: it may have driven all the time.
            tick, driven = self._drove[-1] if self._drove else (state.tick, 0)
            stood_to = tick if before is None or _turns(before) else max(tick, before.tick)
            self._drove.append((state.tick, driven + state.tick - stood_to))
        self.count += 1
        self._came_s.append(self._now())
        self._wake()

    def tick_before(self, ticks: int) -> int | None:
        """Return the tick that lies `ticks` of driving before the robot drove last.

        Returns None if no state showed it driving.
        """
        if not self._drove:
            return None
        newest = self._drove[-1][1]
        tick, driven = next((each for each in reversed(self._drove) if newest - each[1] >= ticks), self._drove[0])
        return max(0, tick - (ticks - (newest - driven)))

    def close(self) -> None:
        """End the stream and wake its readers."""
        self._closed = True
        self._wake()

    async def first(self) -> State | None:
        """Return the newest state, or wait for the first; None if the stream closes before."""
        while self.newest is None and not self._closed:
            await self._changed.wait()
        return self.newest

    async def states(self) -> AsyncIterator[State]:
        """Yield the newest state and each later one until the stream closes; a slow reader misses some."""
        seen = 0
        while not self._closed:
            if self.newest is None or self.count == seen:
                await self._changed.wait()
                continue
            seen = self.count
            yield self.newest

    def _wake(self) -> None:
        self._changed.set()
        self._changed = anyio.Event()


def _turns(state: State) -> bool:
    return bool(state.left_m_s or state.right_m_s)
