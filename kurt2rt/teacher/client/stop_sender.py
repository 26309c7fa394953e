"""A stop overtakes what was to move the robot, and is sent until it is answered or the teacher wishes otherwise."""

import math
import secrets
from collections.abc import Awaitable, Callable
from contextlib import suppress

import anyio
import anyio.abc

from kurt2rt.channel.protocol.requests import COMMAND_ID_BYTES, StopRequest
from kurt2rt.core.rla.outcome import Outcome, RefusalCode
from kurt2rt.teacher.client.answer import Answer, NoAnswerError, local_refusal
from kurt2rt.teacher.client.request_sender import RequestSender


class StopSender:
    """The stops of one device, and the commands that they end."""

    def __init__(self, asking: RequestSender, tasks: anyio.abc.TaskGroup) -> None:
        """A stop that is not answered in time is sent on in `tasks`."""
        self._asking = asking
        self._tasks = tasks
        self._moving: set[anyio.CancelScope] = set()
        self._sent_on: anyio.CancelScope | None = None
        self._wishes = 0

    @property
    def pending(self) -> bool:
        """Whether a stop that was not answered in time is still being sent."""
        return self._sent_on is not None

    async def stop(self) -> Answer:
        """End whatever is to move the robot, and say stop. Raises NoAnswerError, but goes on being sent then."""
        for command in tuple(self._moving):
            command.cancel()
        request = StopRequest(secrets.token_bytes(COMMAND_ID_BYTES))
        wishes = self._wishes
        try:
            answer = await self._asking.ask(request)
        except NoAnswerError as error:
            if wishes != self._wishes:
                raise
            self._send_on(request)
            raise NoAnswerError(
                f"the stop is not answered: no answer for {self._asking.patience_s:g} s; it is sent on until it is. "
                f"{self._asking.trouble}".strip()
            ) from error
        self._end_sending()
        return answer

    async def move(self, what: str, give: Callable[[], Awaitable[Answer]]) -> Answer:
        """Say what may set the robot in motion; a stop that is said before the answer ends it."""
        with anyio.CancelScope() as scope:
            self._moving.add(scope)
            try:
                return await give()
            finally:
                self._moving.discard(scope)
        return local_refusal("stopped", Outcome.of(RefusalCode.STOPPED_MEANWHILE, command=what))

    def wish_anew(self) -> None:
        """The teacher wishes something later than the stop: it is sent no more."""
        self._wishes += 1
        self._end_sending()

    def _send_on(self, request: StopRequest) -> None:
        if self._sent_on is None:
            self._sent_on = anyio.CancelScope()
            self._tasks.start_soon(self._stop_until_answered, request, self._sent_on)

    async def _stop_until_answered(self, request: StopRequest, scope: anyio.CancelScope) -> None:
        with scope, suppress(NoAnswerError):  # one that is not understood is an answer, too
            await self._asking.ask(request, math.inf)
        if self._sent_on is scope:
            self._sent_on = None

    def _end_sending(self) -> None:
        sent_on, self._sent_on = self._sent_on, None
        if sent_on is not None:
            sent_on.cancel()
