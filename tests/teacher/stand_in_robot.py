"""Robot with a real socket, keys and states, whose answers are the test's."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar, cast

import anyio

from kurt2rt.channel.protocol.codec import encode_state
from kurt2rt.channel.protocol.hello import HELLO, AppraisalName, MidIntroduction
from kurt2rt.channel.protocol.requests import CommandRequest, HelloRequest, Request, StreamRequest, TickRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.security.paired_devices import Teachers
from kurt2rt.channel.server.endpoint import open_endpoint
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, refusal
from kurt2rt.channel.server.request_handler import RequestHandler, Sender
from kurt2rt.channel.server.resources import RobotSite
from kurt2rt.core.decision.standing import Standing
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.teaching.commands import Command, StreamCommand
from kurt2rt.teacher import TeacherClient
from tests.channel.states import ASKING, standing_in
from tests.patience import PATIENCE_S
from tests.teacher.page.fake_robot import A_HELLO
from tests.teacher.states_of import state_where

Message = Request | Command
"""Request, or the command in it: what a test of a device looks for."""
Mind = Callable[[Any], Awaitable[Reply]]
"""Answer to a message."""
_PICTURE_EACH_S = 0.05
_TICKS = 5

CRITICS = tuple(AppraisalName(name, value) for name, value in (("bad", -1), ("neutral", 0), ("good", 1)))
MIDS: dict[str, Any] = {"behaviours": ("straight_on", "turn_left"), "mid": MidIntroduction("history", 12, 6.0)}
A_PUPIL = replace(A_HELLO, what="Teach it to follow a wall", appraisals=CRITICS, trusted_from=0.8, seeks=True, **MIDS)
INTRODUCED = Reply(ReplyStatus.DONE, HELLO.plain_of(A_PUPIL))

_Kind = TypeVar("_Kind", bound=Message)
_Thing = TypeVar("_Thing")


async def agrees(request: object) -> Reply:
    return INTRODUCED if isinstance(request, HelloRequest) else done(7)


class SlowMind:
    """Answers as another mind does, but messages of the types `slow` only once it `may_answer`."""

    def __init__(self, *slow: type[Message], mind: Mind = agrees) -> None:
        self.slow = slow
        self.mind = mind
        self.may_answer = anyio.Event()

    async def __call__(self, request: Message) -> Reply:
        if isinstance(request, self.slow):
            await self.may_answer.wait()
        return await self.mind(request)


class StandInRobot:
    """Shows a picture 20 times a second while `showing`, and notes what it hears.

    A device sends a request again after 0.1 s, on a busy machine also one that is answered soon. Such copies count once
    unless `copies` is set; messages of a stream are no copies.
    """

    def __init__(self, teachers: Teachers, boot: bytes, *, showing: bool) -> None:
        self.site = RobotSite(teachers, cast(RequestHandler, self))
        self.port = 0
        self.state: State = replace(ASKING, boot=boot, teacher=None)
        self.standing: Standing | None = None
        self.showing = showing
        self.mind: Mind = agrees
        self.heard: list[Message] = []
        self.boots: list[bytes] = []
        """Start of the robot's program that each of them is meant for; empty for one that names none."""
        self._news = anyio.Event()

    async def answer(self, _sender: Sender, request: Request) -> Reply:
        """Answer a request, as RequestHandler does."""
        message = request.command if isinstance(request, TickRequest | StreamRequest) else request
        self.heard.append(message)
        self.boots.append(getattr(request, "boot", b""))
        self._wake()
        if isinstance(request, StreamRequest | CommandRequest) and request.boot != self.state.boot:
            return refusal("boot", Outcome(RefusalCode.RESTARTED), 7)
        return await self.mind(message)

    def show(self, **changes: Any) -> State:
        """Publish the next state, changed from the last one.

        Its standing is the one that was given last, and follows from the other fields if none was.
        """
        self.standing = changes.pop("standing", self.standing)
        shown = replace(self.state, tick=self.state.tick + _TICKS, **changes)
        self.state = replace(shown, standing=self.standing or standing_in(shown))
        self.site.publish(encode_state(self.state))
        return self.state

    def all_of(self, kind: type[_Kind], *, copies: bool = False) -> list[_Kind]:
        """Return the received requests of one type."""
        heard: list[_Kind] = [each for each in self.heard if isinstance(each, kind)]
        return heard if copies or issubclass(kind, StreamCommand) else list(dict.fromkeys(heard))

    def orders(self) -> list[Message]:
        """Return the received requests that are no streams, each once."""
        return list(dict.fromkeys(each for each in self.heard if not isinstance(each, StreamCommand)))

    async def hears(self, kind: type[_Kind], count: int = 1, *, copies: bool = False) -> list[_Kind]:
        """Wait for `count` requests of a type; return all of it."""
        with anyio.fail_after(PATIENCE_S):
            while len(self.all_of(kind, copies=copies)) < count:
                await self._news.wait()
        return self.all_of(kind, copies=copies)

    async def show_pictures(self) -> None:
        while True:
            if self.showing:
                self.show()
            await anyio.sleep(_PICTURE_EACH_S)

    def _wake(self) -> None:
        self._news.set()
        self._news = anyio.Event()


@asynccontextmanager
async def stand_in_robot(
    folder: Path, *, port: int = 0, boot: bytes = b"boot", showing: bool = True
) -> AsyncIterator[StandInRobot]:
    """Open a robot on loopback for the teachers of a folder; it ends without a farewell, as after a crash."""
    teachers = Teachers(folder)
    robot = StandInRobot(teachers, boot, showing=showing)
    endpoint = await open_endpoint(robot.site, "127.0.0.1", port)
    robot.site.senders = endpoint
    robot.port = endpoint.port
    try:
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(robot.show_pictures)
            yield robot
            tasks.cancel_scope.cancel()
    finally:
        with anyio.CancelScope(shield=True):
            await endpoint.close()
        for name in teachers.names:
            teachers._held[name].context.abandon()


async def looks_at(client: TeacherClient, robot: StandInRobot, **changes: Any) -> State:
    """Show one more picture, and no other from then on; return it when the client has it."""
    robot.showing = False
    return await state_where(client, tick=robot.show(**changes).tick)


@asynccontextmanager
async def in_a_task_of_its_own(manager: AbstractAsyncContextManager[_Thing]) -> AsyncIterator[_Thing]:
    """Enter and exit a context in one task, for fixtures: pytest starts and ends them in different tasks."""
    opened: asyncio.Future[_Thing] = asyncio.get_running_loop().create_future()
    over = asyncio.Event()

    async def hold() -> None:
        async with manager as thing:
            opened.set_result(thing)
            await over.wait()

    holding = asyncio.create_task(hold())
    either: set[asyncio.Future[Any]] = {holding, opened}
    await asyncio.wait(either, return_when=asyncio.FIRST_COMPLETED)
    if not opened.done():
        await holding  # raises what kept it from opening
    try:
        yield opened.result()
    finally:
        over.set()
        await holding
