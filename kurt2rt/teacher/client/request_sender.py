"""How a teacher's device says something and gets its answer: the same message again until the robot answers."""

import secrets
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

import anyio
import anyio.lowlevel

from kurt2rt.channel.protocol.codec import WireError, decode_answer, encode_request
from kurt2rt.channel.protocol.requests import COMMAND_ID_BYTES, CommandRequest, Request, StopRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.rla.outcome import Outcome, RefusalCode
from kurt2rt.teacher.client.answer import Answer, NoAnswerError, answer_of, local_refusal
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.transport import Exchange, OscoreRequests, Response

RESEND_S = 0.1
_MOST_COPIES = 35
"""Of one command that still wait for an answer: those of 3.5 s."""

_Told = TypeVar("_Told")


def facts_of(response: Response) -> dict[str, Any]:
    """Body of a successful response. Raises WireError for any other."""
    body = _body(response)
    if not response.successful:
        raise WireError(f"{response.code} {body.get('text', '')}")
    return body


def answer_to(response: Response) -> Answer:
    """The robot's answer in a response, a refusal too. Raises WireError."""
    return answer_of(response.code, _body(response))


class RequestSender:
    """Requests to one robot. All of them raise NoAnswerError when nobody answers within the patience."""

    def __init__(self, requests: OscoreRequests, pictures: StateStream, patience_s: float) -> None:
        self._requests = requests
        self._pictures = pictures
        self.patience_s = patience_s
        """How long an answer is waited for."""

    @property
    def trouble(self) -> str:
        """Why the robot is not heard, as far as the network tells; empty while it is."""
        return self._requests.trouble

    async def command(self, kind: Callable[..., Request], *, moves: bool = False, **fields: Any) -> Answer:
        """Give a command on the newest picture; `moves` says that it may set the robot in motion."""
        command_id = secrets.token_bytes(COMMAND_ID_BYTES)
        state = await self.picture()
        seen = self._pictures.looked_tick if moves else self._pictures.heard_tick
        return await self.ask(kind(boot=state.boot, command_id=command_id, seen=seen, **fields))

    async def picture(self) -> State:
        """Return the newest picture of the robot, or wait for the first one. Raises NoAnswerError."""
        with anyio.move_on_after(self.patience_s):
            await self._pictures.first()
        state = self._pictures.newest
        if state is None:
            raise NoAnswerError(
                f"there is no picture of the robot, so nothing was sent to it. {self._requests.trouble}".strip()
            )
        return state

    async def ask(self, request: Request, patience_s: float | None = None) -> Answer:
        """Send a request until it is answered; `patience_s` other than the usual, infinite if need be."""
        try:
            payload = encode_request(request)
        except WireError as error:
            return local_refusal("malformed", Outcome.of(RefusalCode.MALFORMED, says=str(error)))
        # A stop names no start of the robot: the one that was seen when it was said, or a later one, took it.
        newest = self._pictures.newest
        boot = request.boot if isinstance(request, CommandRequest) else b"" if newest is None else newest.boot
        response = await self._answered(request.path, payload, patience_s)
        try:
            answer = answer_to(response)
        except WireError as error:
            raise _not_understood(request, error) from error
        if answer.why != "boot":
            self._pictures.hear(boot, answer.tick, stopped=answer.accepted and isinstance(request, StopRequest))
        return answer

    async def told(self, request: Request, read: Callable[[Response], _Told]) -> _Told:
        """Ask for something to read; `read` makes it of the response, or raises WireError."""
        response = await self._answered(request.path, encode_request(request))
        try:
            return read(response)
        except WireError as error:
            raise _not_understood(request, error) from error

    async def _answered(self, path: str, payload: bytes, patience_s: float | None = None) -> Response:
        requests = self._requests
        patience_s = self.patience_s if patience_s is None else patience_s
        answered = anyio.Event()
        responses: list[Response] = []

        def on_response(response: Response) -> None:
            responses.append(response)
            answered.set()

        copies: deque[Exchange] = deque()
        try:
            with anyio.move_on_after(patience_s):
                while not responses:
                    await anyio.lowlevel.checkpoint_if_cancelled()  # nothing is sent behind a stop
                    if len(copies) == _MOST_COPIES:
                        copies.popleft().end()
                    copies.append(requests.post(path, payload, on_response))
                    with anyio.move_on_after(RESEND_S):
                        await answered.wait()
        finally:
            for copy in copies:
                copy.end()
        if not responses:
            raise NoAnswerError(
                f"no answer for {patience_s:g} s: it is not known whether it counted; look at the lessons. "
                f"{requests.trouble}".strip()
            )
        return responses[0]


def _not_understood(request: Request, error: WireError) -> NoAnswerError:
    return NoAnswerError(f"the robot's answer to {request.path} is not understood: {error}")


def _body(response: Response) -> dict[str, Any]:
    return decode_answer(response.payload) if response.payload else {}
