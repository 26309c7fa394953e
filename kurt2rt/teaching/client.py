"""A teacher's device in Python: see the robot, teach it, drive it, over the network.

async with TeacherClient(Path("var/devices/phone")) as robot:
    await robot.take()
    async for state in robot.states():
        if state.cause == "unknown":
            await robot.answer("forward", of=state.tick)
"""

import secrets
import time
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

import anyio
import anyio.to_thread

from kurt2rt.channel.credentials import PORT, Device, read_device
from kurt2rt.channel.requests import (
    COMMAND_ID_BYTES,
    AnswerRequest,
    BehaviourRequest,
    CorrectRequest,
    DeleteRequest,
    ExportRequest,
    HelloRequest,
    LessonsRequest,
    MoveWallRequest,
    PhaseRequest,
    PlaceRequest,
    ReleaseRequest,
    ReplaceRequest,
    Request,
    ResumeRequest,
    RewardRequest,
    SaveRequest,
    SessionRequest,
    StopRequest,
    TakeRequest,
    UndoRequest,
    WorldRequest,
)
from kurt2rt.channel.state import State
from kurt2rt.channel.wire import WireError, decode_answer, decode_state, encode_request
from kurt2rt.rla.rla import Phase
from kurt2rt.teaching.answer import Answer, NoAnswerError, answer_of
from kurt2rt.teaching.hand import BEAT_S, Hand
from kurt2rt.teaching.hello import Hello, hello_of
from kurt2rt.teaching.lesson_line import LessonLine, lesson_lines_of
from kurt2rt.teaching.link import Link
from kurt2rt.teaching.oscore_requests import OscoreRequests, Response, open_requests
from kurt2rt.teaching.pictures import Pictures
from kurt2rt.teaching.wheel import Wheel
from kurt2rt.teaching.world import World, world_of

RESEND_S = 0.1
ANSWER_WITHIN_S = 3.5
SILENT_AFTER_S = 1.0
"""Without a picture for so long the robot is asked for them anew."""
_LOOK_EVERY_S = 0.1
_STOP_WITHIN_S = 0.5
_SEEN_IN_CHARGE_WITHIN_S = 1.0
_STATE = "/state"

_Told = TypeVar("_Told")


class TeacherClient:
    """An async context manager: inside it pictures come, and while this device is in charge the robot is told that its
    teacher is there.

    Commands are sent again every 0.1 s, count once, and come back with the robot's `Answer`; a refusal is one, too.
    They raise NoAnswerError when nobody answered for 3.5 s: then it is not known whether they counted. Speeds are in
    metres per second, ways in metres, angles in radians. One program at a time can use a pairing.
    """

    def __init__(
        self,
        folder: Path,
        host: str | None = None,
        port: int | None = None,
        *,
        patience_s: float = ANSWER_WITHIN_S,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """`folder` is the device's side of a pairing; `host` and `port` of the robot are those noted there, if None.

        `patience_s` is how long an answer is waited for; `now` a monotonic clock in seconds.
        """
        self.name = folder.name
        """Of this device, and so of the teacher."""
        self._folder = folder
        self._host = host
        self._port = port
        self._patience_s = patience_s
        self._now = now
        self._pictures = Pictures(now)
        self._parts: tuple[OscoreRequests, Hand] | None = None
        self._stack = AsyncExitStack()
        self._period_s: float | None = None

    async def __aenter__(self) -> Self:
        """Open the pairing and begin to observe. The robot need not be there yet. Raises CredentialsError."""
        await self._stack.enter_async_context(self._opened())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End a press with a stop, then close."""
        # The error of the block is not shown to the task group, which would wrap it.
        await self._stack.__aexit__(None, None, None)

    # What is seen

    @property
    def state(self) -> State | None:
        """The newest picture; None before the first."""
        return self._pictures.newest

    @property
    def state_age_s(self) -> float:
        """How long ago it came; infinite before the first."""
        return self._pictures.age_s

    @property
    def restarts(self) -> int:
        """How often the robot program was found started anew since this began."""
        return self._pictures.restarts

    @property
    def link(self) -> Link:
        """How well the robot is heard."""
        return self._hand.meter.link(self._pictures.per_s)

    @property
    def trouble(self) -> str:
        """Why the robot is not heard, as far as the network tells; empty while it is."""
        return self._requests.trouble

    def states(self) -> AsyncIterator[State]:
        """Each picture as it comes, the newest first; a slow reader misses some. Ends when the client closes."""
        return self._pictures.states()

    async def hello(self) -> Hello:
        """What robot this is."""
        return await self._told(HelloRequest(), lambda response: hello_of(_facts(response)))

    async def lessons(self, count: int = 10) -> tuple[LessonLine, ...]:
        """The newest lessons, up to 20, newest first."""
        return await self._told(LessonsRequest(count), lambda response: lesson_lines_of(_facts(response)))

    async def world(self) -> World | None:
        """The simulated world; None where the robot is a real one."""
        return await self._told(
            WorldRequest(), lambda response: None if response.code.startswith("4.04") else world_of(_facts(response))
        )

    # Teaching. `of` is the tick of the picture that is meant; None: the present decision.

    async def answer(self, action: str, *, of: int | None = None) -> Answer:
        """Answer a situation: a new RLA (phase 1)."""
        return await self._command(AnswerRequest, action=action, decision_tick=of)

    async def correct(self, action: str, *, of: int | None = None) -> Answer:
        """Another action is right (phase 2)."""
        return await self._command(CorrectRequest, action=action, decision_tick=of)

    async def reward(self, value: int, *, of: int | None = None) -> Answer:
        """Praise (+1) or blame (-1)."""
        return await self._command(RewardRequest, value=value, decision_tick=of)

    async def replace(self, rla: int, action: str) -> Answer:
        """Give one RLA another action."""
        return await self._command(ReplaceRequest, rla_id=rla, action=action)

    async def delete(self, rla: int) -> Answer:
        """Delete one RLA."""
        return await self._command(DeleteRequest, rla_id=rla)

    async def undo(self, lesson: str | None = None) -> Answer:
        """Take a lesson back by its command id; None: the last one that still stands."""
        return await self._command(UndoRequest, lesson=lesson)

    # Organising

    async def set_phase(self, phase: Phase) -> Answer:
        """Another training phase."""
        return await self._command(PhaseRequest, phase=phase)

    async def begin_session(self, name: str) -> Answer:
        """Teaching begins: the teaching clock runs."""
        return await self._command(SessionRequest, name=name)

    async def end_session(self) -> Answer:
        """Teaching ends."""
        return await self._command(SessionRequest, name=None)

    async def take(self) -> Answer:
        """Be the teacher from now on; the robot knows that he is there when this returns."""
        answer = await self._command(TakeRequest)
        if answer.accepted:
            with anyio.move_on_after(_SEEN_IN_CHARGE_WITHIN_S):
                async for state in self.states():
                    if state.teacher == self.name:
                        self._hand.beat()
                        break
        return answer

    async def hand_over(self, to: str | None = None) -> Answer:
        """Be the teacher no longer; `to` is who is next, None: whoever takes it."""
        return await self._command(ReleaseRequest, to=to)

    async def save(self, label: str = "") -> Answer:
        """A copy of the knowledge on the robot; its `name` and `sha256` are in `extra`."""
        return await self._command(SaveRequest, label=label)

    async def export(self) -> Answer:
        """The RLAs as a readable table on the robot; `name` and `sha256` are in `extra`."""
        return await self._command(ExportRequest)

    # Moving

    async def stop(self) -> Answer:
        """Stand; always allowed. A press is over."""
        self._hand.end()
        return await self._ask(StopRequest(secrets.token_bytes(COMMAND_ID_BYTES)))

    async def resume(self) -> Answer:
        """Drive again after a stop."""
        return await self._command(ResumeRequest)

    async def run(self, action: str, *, seconds: float) -> Answer:
        """Run one action of the repertoire for a time; the robot stands afterwards."""
        if self._period_s is None:
            self._period_s = (await self.hello()).period_s
        return await self._command(BehaviourRequest, action=action, ticks=round(seconds / self._period_s))

    @property
    def watching(self) -> bool:
        """Whether the teacher looks at the robot; only then is it told that he is there."""
        return self._hand.watching

    @watching.setter
    def watching(self, watching: bool) -> None:
        self._hand.watching = watching

    @property
    def pressing(self) -> bool:
        """Whether a press is on."""
        return self._hand.pressing

    @property
    def refused(self) -> str:
        """Why the last press was not begun, or ended by itself; empty while all is well."""
        return self._hand.refused

    def press(self, left_m_s: float, right_m_s: float) -> bool:
        """Begin a press or change its speeds; whether one is on. It ends by itself when the robot refuses it, or when
        no picture came for half a second; whoever calls this again then begins another one.

        Raises WireError for speeds that no robot takes.
        """
        return self._hand.press(left_m_s, right_m_s)

    async def let_go(self) -> Answer | None:
        """End the press with a stop; None when none is on."""
        return await self.stop() if self._hand.pressing else None

    @asynccontextmanager
    async def driving(self) -> AsyncIterator[Wheel]:
        """Drive by hand inside the block; the press begins with the first speeds and ends with a stop."""
        try:
            yield Wheel(self._hand)
        except BaseException:
            with anyio.CancelScope(shield=True):
                await self._let_go_anyhow()
            raise
        await self.let_go()

    # The simulated world

    async def move_wall(self, name: str, dx: float, dy: float) -> Answer:
        """Shift a wall or an obstacle."""
        return await self._command(MoveWallRequest, name=name, dx_m=dx, dy_m=dy)

    async def place(self, x: float, y: float, heading: float) -> Answer:
        """Put the robot down elsewhere."""
        return await self._command(PlaceRequest, x_m=x, y_m=y, heading_rad=heading)

    # How it works

    @property
    def _requests(self) -> OscoreRequests:
        return self._opened_parts()[0]

    @property
    def _hand(self) -> Hand:
        return self._opened_parts()[1]

    def _opened_parts(self) -> tuple[OscoreRequests, Hand]:
        if self._parts is None:
            raise RuntimeError("the client is not open; use it as: async with TeacherClient(folder) as robot: ...")
        return self._parts

    @asynccontextmanager
    async def _opened(self) -> AsyncIterator[None]:
        device = await anyio.to_thread.run_sync(_read_device, self._folder)
        self.name = device.name
        requests = await open_requests(self._folder, self._host or device.host, self._port or device.port)
        hand = Hand(self.name, self._pictures, requests, now=self._now)
        self._parts = requests, hand
        try:
            async with anyio.create_task_group() as tasks:
                tasks.start_soon(self._observe, requests)
                tasks.start_soon(_beat, hand)
                try:
                    yield
                finally:
                    with anyio.CancelScope(shield=True):
                        await self._let_go_anyhow()
                    tasks.cancel_scope.cancel()
        finally:
            hand.forget()
            self._pictures.close()
            with anyio.CancelScope(shield=True):
                await requests.close()

    async def _observe(self, requests: OscoreRequests) -> None:
        while True:
            before, began_s, newest = self._pictures.count, self._now(), -2

            def on_response(response: Response) -> None:
                nonlocal newest
                # A captured picture that is sent again must not be shown, and none may overtake a newer one.
                if response.number <= newest:
                    return
                newest = response.number
                self._show(response, requests)

            observation = requests.observe(_STATE, on_response)
            while True:
                await anyio.sleep(_LOOK_EVERY_S)
                came = self._pictures.count > before
                if observation.ended and came:
                    break
                if self._now() - began_s > SILENT_AFTER_S and self._pictures.age_s > SILENT_AFTER_S:
                    break
            observation.end()
            if self._pictures.count == before:
                await requests.find_robot()  # it may have another address by now

    def _show(self, response: Response, requests: OscoreRequests) -> None:
        if not response.successful:
            requests.trouble = f"the robot shows no picture: {response.code}"
            return
        try:
            picture = decode_state(response.payload)
        except WireError as error:
            requests.trouble = f"the robot's picture is not understood, it may be of another version: {error}"
        else:
            self._pictures.show(picture)

    async def _command(self, kind: Callable[..., Request], **fields: Any) -> Answer:
        command_id = secrets.token_bytes(COMMAND_ID_BYTES)
        with anyio.move_on_after(self._patience_s):
            await self._pictures.first()
        state = self._pictures.newest
        if state is None:
            raise NoAnswerError(f"there is no picture of the robot, so nothing was sent to it. {self.trouble}".strip())
        return await self._ask(kind(boot=state.boot, command_id=command_id, seen=state.tick, **fields))

    async def _ask(self, request: Request) -> Answer:
        try:
            payload = encode_request(request)
        except WireError as error:
            return Answer(False, "malformed", str(error), -1)
        response = await self._answered(request.path, payload)
        try:
            return answer_of(response.code, _body(response))
        except WireError as error:
            raise NoAnswerError(f"the robot's answer to {request.path} is not understood: {error}") from error

    async def _told(self, request: Request, read: Callable[[Response], _Told]) -> _Told:
        response = await self._answered(request.path, encode_request(request))
        try:
            return read(response)
        except WireError as error:
            raise NoAnswerError(f"the robot's answer to {request.path} is not understood: {error}") from error

    async def _answered(self, path: str, payload: bytes) -> Response:
        requests = self._requests
        answered = anyio.Event()
        responses: list[Response] = []

        def on_response(response: Response) -> None:
            responses.append(response)
            answered.set()

        copies = []
        try:
            with anyio.move_on_after(self._patience_s):
                while not responses:
                    copies.append(requests.post(path, payload, on_response))
                    with anyio.move_on_after(RESEND_S):
                        await answered.wait()
        finally:
            for copy in copies:
                copy.end()
        if not responses:
            raise NoAnswerError(
                f"no answer for {self._patience_s:g} s: it is not known whether it counted; look at the lessons. "
                f"{requests.trouble}".strip()
            )
        return responses[0]

    async def _let_go_anyhow(self) -> None:
        # The robot lets go by itself when it hears nothing, so a stop that nobody answers is no error here.
        with anyio.move_on_after(_STOP_WITHIN_S), suppress(NoAnswerError):
            await self.let_go()


async def _beat(hand: Hand) -> None:
    due_s = anyio.current_time()
    while True:
        hand.beat()
        # No burst after a pause: what was missed is missed.
        due_s = max(due_s + BEAT_S, anyio.current_time())
        await anyio.sleep_until(due_s)


def _facts(response: Response) -> dict[str, Any]:
    body = _body(response)
    if not response.successful:
        raise WireError(f"{response.code} {body.get('text', '')}")
    return body


def _body(response: Response) -> dict[str, Any]:
    return decode_answer(response.payload) if response.payload else {}


def _read_device(folder: Path) -> Device:
    if not (folder / "device.json").exists():
        return Device(folder, folder.name, "127.0.0.1", PORT, "")
    return read_device(folder)
