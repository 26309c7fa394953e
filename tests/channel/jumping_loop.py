"""An event loop whose time jumps to the next deadline: real sockets, real keys, a real disk, and no waiting.

On loopback a datagram is in the other socket's queue when `sendto` returns, so a loop with nothing to read really has
nothing to do before its next timer. The time of a `SteppedLoop` stands until a test lets some of it pass.
"""

import asyncio
import functools
import math
import selectors
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Self, TypeVar, cast

import anyio
import anyio.to_thread
import pytest

from kurt2rt.channel.server.endpoint import open_endpoint
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter

_Told = TypeVar("_Told")
_DISK_S = 30.0
_ROUNDING_S = 1e-7
"""Timers due within it fire together."""
_MOST_TURNS = 500
"""Turns in a row that only call each other, as anyio cancels a task in each turn: a timer has to end them."""
_TURNS = 20
"""Turns in which what began at the end of a time is done."""
_STUCK_S = 30.0
"""Real seconds in which a loop without any timer has to get something to read, or it never will."""


class _JumpingSelector(selectors.DefaultSelector):
    """Selector that jumps the clock instead of waiting."""

    def __init__(self, next_s: Callable[[], float]) -> None:
        """`next_s`: returns the time of the next timer, infinite without one."""
        super().__init__()
        self.next_s = next_s
        self._turns = 0
        self.now_s = 0.0
        self.until_s = math.inf
        """Time at which the clock stands."""

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        ready = super().select(0)
        self._turns = 0 if ready or timeout != 0 else self._turns + 1
        if ready or (timeout == 0 and self._turns < _MOST_TURNS):
            return ready
        self._turns = 0
        if timeout is None and self.until_s == math.inf:
            ready = super().select(_STUCK_S)
            assert ready, "nothing is under way and no timer runs: this test would wait for ever"
            return ready
        due_s = self.next_s()
        if due_s > self.until_s + _ROUNDING_S:
            self.now_s = max(self.now_s, self.until_s)
            return super().select(timeout and None)
        # Not by the timeout: a time that is less than the timer's by its rounding would set that timer again for ever.
        self.now_s = max(self.now_s, due_s)
        return []


class JumpingLoop(asyncio.SelectorEventLoop):
    """Time begins at 0 and is the same in every run. Threads would race against it: what uses one works in place."""

    def __init__(self) -> None:
        self._scheduled: list[asyncio.TimerHandle]  # asyncio's heap of timers
        self._jumping = _JumpingSelector(lambda: self._scheduled[0].when() if self._scheduled else math.inf)
        super().__init__(self._jumping)
        self._clock_resolution = _ROUNDING_S  # asyncio's

    def time(self) -> float:
        """Return the simulated time in seconds."""
        return self._jumping.now_s

    def run_in_executor(self, _: Any, func: Callable[..., Any], *args: Any) -> Any:  # type: ignore[override]
        """Do it now."""
        done = self.create_future()
        done.set_result(func(*args))
        return done


class SteppedLoop(JumpingLoop):
    """Loop that serves sockets and other threads at once, and whose timers wait until the test lets time pass."""

    def __init__(self) -> None:
        super().__init__()
        self._jumping.until_s = 0.0

    async def jump(self) -> None:
        """Let time jump from here on, as a JumpingLoop does: what ends waits for no test."""
        self._jumping.until_s = math.inf

    async def pass_time(self, seconds: float) -> None:
        """Let all happen that happens in so many seconds."""
        self._jumping.until_s += seconds
        await asyncio.sleep(self._jumping.until_s - self.time())
        for _ in range(_TURNS):
            await asyncio.sleep(0)


class LoopClock:
    """The runtime's clock on the time of the running loop (kurt2rt.platform.clock.Clock)."""

    def __enter__(self) -> Self:
        self._loop = asyncio.get_running_loop()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        pass

    def now_s(self) -> float:
        return self._loop.time()

    async def wait_until(self, deadline_s: float) -> None:
        await asyncio.sleep(max(0.0, deadline_s - self._loop.time()))


class _PromptWriter(JournalWriter):
    """Journal writer that writes the lessons of a tick before the next one, in no simulated time."""

    def acknowledged(self) -> list[Acknowledgement]:
        if self.unwritten:
            assert self.flush(_DISK_S)
        return super().acknowledged()


_in_a_thread = anyio.to_thread.run_sync


async def _in_place(work: Callable[..., Any], *args: Any, **options: Any) -> Any:
    if isinstance(asyncio.get_running_loop(), JumpingLoop):
        return work(*args)
    return await _in_a_thread(work, *args, **options)


@contextmanager
def no_other_time() -> Iterator[None]:
    """Keep the robot's service and its channel to the time of their loop, and to its thread, meanwhile."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("kurt2rt.service.serve.TimerfdClock", LoopClock)
        patch.setattr("kurt2rt.service.serve.JournalWriter", _PromptWriter)
        now = lambda: asyncio.get_running_loop().time()  # noqa: E731
        patch.setattr("kurt2rt.channel.server.channel.open_endpoint", functools.partial(open_endpoint, now=now))
        patch.setattr("anyio.to_thread.run_sync", _in_place)
        yield


def run_jumping(story: Callable[[], Coroutine[Any, Any, _Told]]) -> _Told:
    """Run a story to its end in simulated time, the robot's service and its channel with it."""
    with no_other_time(), asyncio.Runner(loop_factory=cast(Callable[[], Any], JumpingLoop)) as runner:
        return runner.run(story())
