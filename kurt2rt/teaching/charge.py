"""A teacher's device in charge: who teaches, since when, in which phase, and what is kept of it on the robot."""

import anyio

from kurt2rt.channel.requests import (
    ExportRequest,
    PhaseRequest,
    ReleaseRequest,
    SaveRequest,
    SessionRequest,
    TakeRequest,
)
from kurt2rt.rla.rla import Phase
from kurt2rt.teaching.answer import Answer
from kurt2rt.teaching.sight import Sight

_SEEN_IN_CHARGE_WITHIN_S = 1.0


class Charge(Sight):
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

    async def export(self) -> Answer:
        """The RLAs as a readable table on the robot; `name` and `sha256` are in `extra`."""
        return await self._asking.command(ExportRequest)

    async def set_phase(self, phase: Phase) -> Answer:
        """Another training phase. In phase 5 the robot drives without its teacher, so a stop ends that command."""
        if phase is not Phase.AUTONOMOUS:
            return await self._asking.command(PhaseRequest, phase=phase)
        return await self._stopping.move("phase 5", lambda: self._asking.command(PhaseRequest, moves=True, phase=phase))
