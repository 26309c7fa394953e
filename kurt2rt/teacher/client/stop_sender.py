"""Stops of one device: they overtake commands that move the robot, and are sent until answered or superseded."""

import math
import secrets
from collections.abc import Awaitable, Callable
from contextlib import suppress

import anyio
import anyio.abc

from kurt2rt.channel.protocol.limits import COMMAND_ID_BYTES
from kurt2rt.channel.protocol.requests import StopRequest
from kurt2rt.core.outcome import RefusalCode
from kurt2rt.teacher.client.answer import Answer, NoAnswer, NoAnswerError, local_refusal
from kurt2rt.teacher.client.request_sender import RequestSender


class StopSender:
    """Sender of one device's stops, which first withdraw the commands that would move the robot.

    A stop without an answer is sent on.
    """

    def __init__(self, sender: RequestSender, tasks: anyio.abc.TaskGroup) -> None:
        """Go on sending an unanswered stop in `tasks`."""
        self._sender = sender
        self._tasks = tasks
        self._moving: set[anyio.CancelScope] = set()
        self._resending: anyio.CancelScope | None = None
        self._superseded = 0

    @property
    def pending(self) -> bool:
        """True while a stop that was not answered in time is being sent."""
        return self._resending is not None

    async def stop(self) -> Answer:
        """Cancel the moving commands and send a stop. Raises NoAnswerError; the stop goes on being sent then."""
        for command in tuple(self._moving):
            command.cancel()
        request = StopRequest(secrets.token_bytes(COMMAND_ID_BYTES))
        superseded = self._superseded
        try:
            answer = await self._sender.send(request)
        except NoAnswerError as error:
            if superseded != self._superseded:
                raise
            self._begin_resending(request)
            raise NoAnswerError(
                code=NoAnswer.STOP_UNANSWERED, trouble=self._sender.trouble, after_s=self._sender.patience_s
            ) from error
        self._end_resending()
        return answer

    async def move(self, name: str, send: Callable[[], Awaitable[Answer]]) -> Answer:
        """Return the answer to a command that may set the robot in motion, or its refusal if a stop came first.

        `name`: of the command, for the refusal. Raises the errors of `send`.
        """
        with anyio.CancelScope() as scope:
            self._moving.add(scope)
            try:
                return await send()
            finally:
                self._moving.discard(scope)
        return local_refusal(RefusalCode.STOPPED_MEANWHILE, command=name)

    def supersede(self) -> None:
        """End the resending of a stop, because the teacher gave a later command."""
        self._superseded += 1
        self._end_resending()

    def _begin_resending(self, request: StopRequest) -> None:
        if self._resending is None:
            self._resending = anyio.CancelScope()
            self._tasks.start_soon(self._send_until_answered, request, self._resending)

    async def _send_until_answered(self, request: StopRequest, scope: anyio.CancelScope) -> None:
        with scope, suppress(NoAnswerError):  # an answer that is not understood ends it too
            await self._sender.send(request, math.inf)
        if self._resending is scope:
            self._resending = None

    def _end_resending(self) -> None:
        resending, self._resending = self._resending, None
        if resending is not None:
            resending.cancel()
