"""An event loop whose time jumps to the next deadline: real sockets, real keys, a real disk, and no waiting.

On loopback a datagram is in the other socket's queue when `sendto` returns, so a loop with nothing to read really has
nothing to do before its next timer.
"""

import asyncio
import functools
import selectors
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Self, TypeVar, cast

import pytest

from kurt2rt.channel.server.endpoint import open_endpoint
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter

_Told = TypeVar("_Told")
_DISK_S = 30.0
_STUCK_S = 30.0
"""Real seconds in which a loop without any timer has to get something to read, or it never will."""


class _JumpingSelector(selectors.DefaultSelector):
    """Selector that jumps the clock instead of waiting."""

    def __init__(self) -> None:
        super().__init__()
        self.now_s = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        ready = super().select(0)
        if ready or timeout == 0:
            return ready
        if timeout is None:
            ready = super().select(_STUCK_S)
            assert ready, "nothing is under way and no timer runs: this test would wait for ever"
            return ready
        self.now_s += max(0.0, timeout)
        return []


class JumpingLoop(asyncio.SelectorEventLoop):
    """Time begins at 0 and is the same in every run. Threads would race against it: what uses one works in place."""

    def __init__(self) -> None:
        self._jumping = _JumpingSelector()
        super().__init__(self._jumping)
        self._clock_resolution = 1e-7  # asyncio's: timers due within it fire together

    def time(self) -> float:
        """Return the simulated time in seconds."""
        return self._jumping.now_s

    def run_in_executor(self, _: Any, func: Callable[..., Any], *args: Any) -> Any:  # type: ignore[override]
        """Do it now."""
        done = self.create_future()
        done.set_result(func(*args))
        return done


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


async def _in_place(work: Callable[..., _Told], *args: Any, **_: Any) -> _Told:
    return work(*args)


@contextmanager
def _no_other_time() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("kurt2rt.service.serve.TimerfdClock", LoopClock)
        patch.setattr("kurt2rt.service.serve.JournalWriter", _PromptWriter)
        now = lambda: asyncio.get_running_loop().time()  # noqa: E731
        patch.setattr("kurt2rt.channel.server.channel.open_endpoint", functools.partial(open_endpoint, now=now))
        patch.setattr("anyio.to_thread.run_sync", _in_place)
        yield


def run_jumping(story: Callable[[], Coroutine[Any, Any, _Told]]) -> _Told:
    """Run a story to its end in simulated time, the robot's service and its channel with it."""
    with _no_other_time(), asyncio.Runner(loop_factory=cast(Callable[[], Any], JumpingLoop)) as runner:
        return runner.run(story())
