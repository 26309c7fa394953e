"""A teacher for scripts and notebooks: `TeacherClient` without async.

with Teacher("var/devices/local") as teacher:
    teacher.send(Take)
    asking = teacher.wait_for_question()
    teacher.send(Teach, action="forward", decision_tick=asking.tick)
"""

import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import ExitStack
from functools import wraps
from pathlib import Path
from typing import Concatenate, ParamSpec, Self, TypeVar

import anyio
from anyio.from_thread import BlockingPortal, start_blocking_portal

from kurt2rt.channel.protocol.state import State
from kurt2rt.teacher.client.answer import NoAnswer, NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.client.link_quality import LinkQuality
from kurt2rt.teacher.client.observer_client import ANSWER_WITHIN_S

LOCAL_DEVICE = Path("var/devices/local")
"""Pairing that `kurt2rt run` makes for programs of its own machine."""
ATTENTION_S = 1.0
"""Default of `attention_s`, in seconds."""

_POLL_S = 0.05

_Args = ParamSpec("_Args")
_Result = TypeVar("_Result")


def _blocking(
    method: Callable[Concatenate[TeacherClient, _Args], Awaitable[_Result]],
) -> Callable[Concatenate["Teacher", _Args], _Result]:
    """Return a method of `Teacher` that calls a method of its client in the loop's thread."""

    @wraps(method)
    def call(teacher: "Teacher", /, *args: _Args.args, **kwargs: _Args.kwargs) -> _Result:
        return teacher._call(lambda: method(teacher._client, *args, **kwargs))

    return call


class Teacher:
    """Blocking teacher's device; its event loop runs in a thread, so it works where a loop runs already (Jupyter).

    Use it as a context manager, or call `open` in one notebook cell and `close` in a later one. Commands return the
    robot's `Answer`; a refusal is an Answer too. Each call raises NoAnswerError if the robot does not answer within
    `patience_s`, and RuntimeError while the Teacher is not open.

    Its teacher counts as present during each call and for `attention_s` after it. Then it stands, and
    drives on only after `Resume`: if the script hangs or computes for longer, and between two notebook cells.

    Use one Teacher from one thread at a time. Speeds are in metres per second.
    """

    def __init__(
        self,
        folder: Path | str = LOCAL_DEVICE,
        host: str | None = None,
        port: int | None = None,
        *,
        patience_s: float = ANSWER_WITHIN_S,
        connect_s: float = 10.0,
        attention_s: float = ATTENTION_S,
    ) -> None:
        """Name the robot; nothing is sent before `open`.

        Args:
            folder: Device's side of a pairing. Default: the one that `kurt2rt run` makes below its working folder.
            host: Address of the robot. None: as noted in the pairing.
            port: UDP port of the robot. None: as noted in the pairing.
            patience_s: Seconds to wait for the answer to a call.
            connect_s: Seconds to wait for the robot in `open`.
            attention_s: Seconds after the last call during which the robot may still drive.
        """
        self._folder = Path(folder)
        self._host = host
        self._port = port
        self._patience_s = patience_s
        self._connect_s = connect_s
        self._attention_s = attention_s
        self._portal: BlockingPortal | None = None
        self._robot: TeacherClient | None = None
        self._stack = ExitStack()
        self._calls = 0
        self._attentive_until_s = 0.0
        self._newest_read: State | None = None

    # Opening and closing

    def open(self) -> Self:
        """Connect to the robot.

        Raises:
            CredentialsError: The pairing is missing, damaged, or used by another program.
            NoAnswerError: No robot answers within `connect_s`.
            RuntimeError: It is open already.
        """
        if self._robot is not None:
            raise RuntimeError(f"{self._folder}: this Teacher is open already; close it first")
        with ExitStack() as stack:
            self._portal = stack.enter_context(start_blocking_portal(name="teacher"))
            client = TeacherClient(self._folder, self._host, self._port, patience_s=self._patience_s)
            self._robot = stack.enter_context(self._portal.wrap_async_context_manager(client))
            stack.callback(self._drop_client)
            attention = self._portal.start_task_soon(self._end_attention)
            stack.callback(attention.cancel)
            self._call(self._find_robot)
            self._stack = stack.pop_all()
        return self

    def close(self) -> None:
        """End the connection; the robot stands because its teacher is gone. Closing twice does nothing."""
        self._stack.close()

    def __enter__(self) -> Self:
        """Connect to the robot, as `open` does."""
        return self.open()

    def __exit__(self, *_: object) -> None:
        """End the connection, as `close` does."""
        self.close()

    # State

    @property
    def state(self) -> State:
        """Newest state of the robot, which sends 20 a second."""
        return self._call(self._newest)

    @property
    def link(self) -> LinkQuality:
        """Round trip, answered fraction and states per second."""
        return self._client.link

    def states(self) -> Iterator[State]:
        """Yield each state as it comes, without end; a slow reader misses some.

        Raises:
            NoAnswerError: No state came for `patience_s`.
        """
        while True:
            self._newest_read = self._call(self._next)
            yield self._newest_read

    def wait_until(self, met: Callable[[State], bool], timeout_s: float = 60.0) -> State:
        """Return the first state for which `met` returns True.

        Raises:
            TimeoutError: No such state within `timeout_s`.
            NoAnswerError: No state came for `patience_s`.
        """
        ends_s = time.monotonic() + timeout_s
        state = self.state
        while not met(state):
            if time.monotonic() >= ends_s:
                raise TimeoutError(
                    f"waited {timeout_s:g} s; the robot's newest state: {state.cause} at tick {state.tick}"
                )
            state = next(self.states())
        return state

    def wait_for_question(self, timeout_s: float = 60.0) -> State:
        """Return the next state in which an answer lets the robot drive on.

        Raises:
            TimeoutError: No such state within `timeout_s`.
            NoAnswerError: No state came for `patience_s`.
        """
        return self.wait_until(lambda state: state.standing.asks and not state.standing.needs_resume, timeout_s)

    hello = _blocking(TeacherClient.hello)
    world = _blocking(TeacherClient.world)
    why = _blocking(TeacherClient.why)

    # Commands

    send = _blocking(TeacherClient.send)
    stop = _blocking(TeacherClient.stop)
    run = _blocking(TeacherClient.run)
    lessons = _blocking(TeacherClient.lessons)
    correct_earlier = _blocking(TeacherClient.correct_earlier)
    teach_shown = _blocking(TeacherClient.teach_shown)
    hold_for = _blocking(TeacherClient.hold_for)

    def drive(self, left_m_s: float, right_m_s: float, seconds: float) -> str:
        """Drive by hand for a time, then stop.

        An exception in the calling thread, such as KeyboardInterrupt, ends the drive at once.

        Returns:
            Why the drive ended before its time, in a sentence; empty if it lasted.

        Raises:
            WireError: The speeds are out of range.
        """
        return self._call(lambda: self._drive(left_m_s, right_m_s, seconds))

    # In the caller's thread

    @property
    def _client(self) -> TeacherClient:
        if self._robot is None:
            raise RuntimeError(
                "this Teacher is not open; use it as: with Teacher(folder) as teacher: ... (or call open() first)"
            )
        return self._robot

    def _drop_client(self) -> None:
        self._robot = self._newest_read = None

    def _call(self, make: Callable[[], Awaitable[_Result]]) -> _Result:
        client, portal = self._client, self._portal
        assert portal is not None

        async def attended() -> _Result:
            self._calls += 1
            client.watching = True
            try:
                return await make()
            finally:
                self._calls -= 1
                self._attentive_until_s = time.monotonic() + self._attention_s

        future = portal.start_task_soon(attended)
        try:
            return future.result()
        except BaseException:
            future.cancel()  # after KeyboardInterrupt: a drive by hand must not go on in the other thread
            raise

    # In the loop's thread

    async def _end_attention(self) -> None:
        while True:
            await anyio.sleep(_POLL_S)
            if not self._calls and time.monotonic() >= self._attentive_until_s:
                self._client.watching = False

    async def _find_robot(self) -> None:
        with anyio.move_on_after(self._connect_s):
            await anext(self._client.states())
            return
        why = f" ({self._client.trouble})" if self._client.trouble else ""
        raise NoAnswerError(
            f"for {self._connect_s:g} s{why}", NoAnswer.NO_ROBOT, where=self._folder, do="start one: kurt2rt run"
        )

    async def _newest(self) -> State:
        state = self._client.state
        return state if state is not None and self._client.state_age_s < self._patience_s else await self._next()

    async def _next(self) -> State:
        with anyio.move_on_after(self._patience_s):
            async for state in self._client.states():
                if state is not self._newest_read:
                    return state
        raise NoAnswerError(code=NoAnswer.SILENT, trouble=self._client.trouble, after_s=self._patience_s)

    async def _drive(self, left_m_s: float, right_m_s: float, seconds: float) -> str:
        async with self._client.driving() as handle:
            if not handle.set((left_m_s, right_m_s)):
                refusal = handle.ended or self._client.refusal
                return "" if refusal is None else refusal.text or refusal.why
            await handle.wait(seconds)
            return "" if handle.ended is None else handle.ended.text or handle.ended.why
