"""A teacher's device in charge: who teaches, since when, in which phase, and what is kept of it on the robot."""

from collections.abc import AsyncIterator

import anyio

from kurt2rt.channel.protocol.exam_status import EXAM, ExamStatus
from kurt2rt.channel.protocol.requests import (
    LARGEST_NUMBER,
    PART_BYTES,
    TABLE,
    ExamRequest,
    ExamStandingRequest,
    ExportRequest,
    FileRequest,
    PhaseRequest,
    ReleaseRequest,
    SaveRequest,
    SessionRequest,
    TakeRequest,
)
from kurt2rt.channel.protocol.schema import Int, WireError
from kurt2rt.core.rla.rla import Phase
from kurt2rt.platform.file_part import FilePart
from kurt2rt.teacher.client.answer import Answer, RefusedError
from kurt2rt.teacher.client.request_sender import answer_to, facts_of
from kurt2rt.teacher.client.state import StateMixin
from kurt2rt.teacher.client.transport import Response

_SEEN_IN_CHARGE_WITHIN_S = 1.0


class SessionMixin(StateMixin):
    """To be the teacher, and to organise the lessons. Each raises NoAnswerError when nobody answers."""

    name: str
    """Of this device, and so of the teacher."""

    async def begin_session(self, name: str) -> Answer:
        """Teaching begins: the teaching clock runs."""
        return await self._asking.command(SessionRequest, name=name)

    async def end_session(self) -> Answer:
        """Teaching ends."""
        return await self._asking.command(SessionRequest, name=None)

    async def take(self) -> Answer:
        """Be the teacher from now on; the robot knows that he is there when this returns."""
        answer = await self._stopping.move("take", lambda: self._asking.command(TakeRequest, moves=True))
        if answer.accepted:
            with anyio.move_on_after(_SEEN_IN_CHARGE_WITHIN_S):
                async for state in self.states():
                    if state.teacher == self.name:
                        self._hand.beat()
                        break
        return answer

    async def hand_over(self, to: str | None = None) -> Answer:
        """Be the teacher no longer; `to` is who is next, None: whoever takes it."""
        return await self._asking.command(ReleaseRequest, to=to)

    async def save(self, label: str = "") -> Answer:
        """A copy of the knowledge on the robot; its `name` and `sha256` are in `extra`."""
        return await self._asking.command(SaveRequest, label=label)

    async def export(self, form: str = TABLE) -> Answer:
        """The RLAs as a readable table on the robot, or with PACKAGE one file to give away, as `save` answers."""
        return await self._asking.command(ExportRequest, form=form)

    async def examine(self) -> Answer:
        """Examine a copy of the present knowledge, a simulated robot's only; `exam` tells how it stands."""
        return await self._asking.command(ExamRequest)

    async def exam(self) -> ExamStatus | None:
        """Return how the newest exam stands; None for a robot that is not simulated in its own program."""

        def read(response: Response) -> ExamStatus | None:
            return None if response.code.startswith("4.04") else EXAM.read(facts_of(response).get("exam"))

        return await self._asking.told(ExamStandingRequest(), read)

    async def file_parts(self, name: str) -> AsyncIterator[FilePart]:
        """Yield the parts of a file that `save` or `export` made on the robot, in order, at least one.

        Raises RefusedError for a file that the robot does not have, NoAnswerError.
        """
        offset = 0
        while True:
            part = await self._asking.told(FileRequest(name, offset), _part_of)
            yield part
            offset += len(part.content)
            if offset >= part.size_bytes or not part.content:
                return

    async def set_phase(self, phase: Phase) -> Answer:
        """Another training phase. In phase 5 the robot drives without its teacher, so a stop ends that command."""
        if phase is not Phase.AUTONOMOUS:
            return await self._asking.command(PhaseRequest, phase=phase)
        return await self._stopping.move("phase 5", lambda: self._asking.command(PhaseRequest, moves=True, phase=phase))


def _part_of(response: Response) -> FilePart:
    """Raises RefusedError where the robot says why not, WireError."""
    if not response.successful:
        answer = answer_to(response)
        raise RefusedError(answer.text or response.code, answer)
    body = facts_of(response)
    content = body.get("part")
    if not isinstance(content, bytes) or len(content) > PART_BYTES:
        raise WireError(f"part has to be up to {PART_BYTES} bytes")
    return FilePart(Int(0, LARGEST_NUMBER)("size", body.get("size")), content)
