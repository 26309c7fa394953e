"""Requests of a teacher's device, each sent again until the robot answers it."""

import secrets
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

import anyio
import anyio.lowlevel

from kurt2rt.channel.protocol.codec import decode_answer, encode_request, path_of
from kurt2rt.channel.protocol.limits import COMMAND_ID_BYTES, PART_BYTES
from kurt2rt.channel.protocol.requests import CommandRequest, Request, StopRequest, tick_request
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.message_fields import Number, WireError, check_of
from kurt2rt.core.outcome import RefusalCode
from kurt2rt.core.teaching.commands import Single
from kurt2rt.platform.file_part import FilePart
from kurt2rt.teacher.client.answer import Answer, NoAnswer, NoAnswerError, RefusedError, answer_of, local_refusal
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.transport import Exchange, OscoreRequests, Response

RESEND_S = 0.1
_MOST_COPIES = 35
"""Most copies of one command that wait for an answer: those of 3.5 s."""

_Read = TypeVar("_Read")


class RequestSender:
    """Sender of requests to one robot, each until it is answered.

    Each method raises NoAnswerError if no answer comes in time.
    """

    def __init__(self, requests: OscoreRequests, stream: StateStream, patience_s: float) -> None:
        """`patience_s` is the time to wait for an answer, in seconds."""
        self._requests = requests
        self._stream = stream
        self.patience_s = patience_s

    @property
    def trouble(self) -> str:
        """Reason why the robot is not reached, as far as the network tells; empty while it is."""
        return self._requests.trouble

    async def command(self, kind: type[Single | CommandRequest], **fields: Any) -> Answer:
        """Send a command for the newest state.

        Args:
            kind: class of the command, or of a request that is none for the tick.
            fields: its fields, except teacher, boot, command id and seen tick.

        Raises:
            NoAnswerError: no state or no answer comes in time.
        """
        command_id = secrets.token_bytes(COMMAND_ID_BYTES)
        state = await self.state()
        seen = self._stream.displayed_tick if kind.moves else self._stream.newest_tick
        if issubclass(kind, CommandRequest):
            return await self.send(kind(boot=state.boot, command_id=command_id, seen=seen, **fields))
        return await self.send(tick_request(kind, state.boot, command_id, seen, **fields))

    async def state(self) -> State:
        """Return the newest state of the robot, or wait for the first one. Raises NoAnswerError."""
        with anyio.move_on_after(self.patience_s):
            await self._stream.first()
        state = self._stream.newest
        if state is None:
            raise NoAnswerError(code=NoAnswer.NO_STATE, trouble=self._requests.trouble)
        return state

    async def send(self, request: Request, patience_s: float | None = None) -> Answer:
        """Send a request until it is answered, for `patience_s` seconds (None: the usual time; inf: without end).

        A request that cannot be encoded is answered by a local refusal. Raises NoAnswerError.
        """
        try:
            payload = encode_request(request)
        except WireError as error:
            return local_refusal(RefusalCode.MALFORMED, says=str(error))
        # A stop names no start of the robot: the start that was seen when it was sent, or a later one, carried it out.
        newest = self._stream.newest
        boot = request.boot if isinstance(request, CommandRequest) else b"" if newest is None else newest.boot
        response = await self._exchange(path_of(request), payload, patience_s)
        try:
            answer = _answer_in(response)
        except WireError as error:
            raise _not_understood(request, error) from error
        if answer.code is not RefusalCode.RESTARTED:
            self._stream.on_answer(boot, answer.tick, stopped=answer.accepted and isinstance(request, StopRequest))
        return answer

    async def query(self, request: Request, read: Callable[[dict[str, Any]], _Read]) -> _Read:
        """Send a query and return the result of `read` for the answer's body; `read` may raise WireError.

        Raises NoAnswerError, also for an answer that cannot be read.
        """
        return await self._query(request, lambda response: read(_body_of(response)))

    async def query_simulated(self, request: Request, read: Callable[[dict[str, Any]], _Read]) -> _Read | None:
        """Send a query that only a simulated robot answers; return None for any other robot.

        `read` returns the result from the answer's body and may raise WireError. Raises NoAnswerError.
        """
        return await self._query(
            request, lambda response: None if response.code.startswith("4.04") else read(_body_of(response))
        )

    async def file_part(self, request: Request) -> FilePart:
        """Return one part of a file of the robot.

        Raises RefusedError if the robot refuses it, NoAnswerError.
        """
        return await self._query(request, _file_part_in)

    async def _query(self, request: Request, read: Callable[[Response], _Read]) -> _Read:
        response = await self._exchange(path_of(request), encode_request(request))
        try:
            return read(response)
        except WireError as error:
            raise _not_understood(request, error) from error

    async def _exchange(self, path: str, payload: bytes, patience_s: float | None = None) -> Response:
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
                    await anyio.lowlevel.checkpoint_if_cancelled()  # a command ended by a stop sends no further copy
                    if len(copies) == _MOST_COPIES:
                        copies.popleft().end()
                    copies.append(requests.post(path, payload, on_response))
                    with anyio.move_on_after(RESEND_S):
                        await answered.wait()
        finally:
            for copy in copies:
                copy.end()
        if not responses:
            raise NoAnswerError(code=NoAnswer.NO_REPLY, trouble=requests.trouble, after_s=patience_s)
        return responses[0]


def _not_understood(request: Request, error: WireError) -> NoAnswerError:
    return NoAnswerError(str(error), NoAnswer.NOT_UNDERSTOOD, path=path_of(request))


def _decode(response: Response) -> dict[str, Any]:
    return decode_answer(response.payload) if response.payload else {}


def _answer_in(response: Response) -> Answer:
    return answer_of(response.code, _decode(response))


def _body_of(response: Response) -> dict[str, Any]:
    """Return the body of a successful response. Raises WireError for any other."""
    body = _decode(response)
    if not response.successful:
        raise WireError(f"{response.code} {body.get('text', '')}")
    return body


def _file_part_in(response: Response) -> FilePart:
    if not response.successful:
        answer = _answer_in(response)
        raise RefusedError(answer.text or response.code, answer)
    body = _body_of(response)
    content = body.get("part")
    if not isinstance(content, bytes) or len(content) > PART_BYTES:
        raise WireError(f"part has to be up to {PART_BYTES} bytes")
    return FilePart(check_of(Number)("size", body.get("size")), content)
