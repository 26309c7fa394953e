"""Where a teacher's device sends its robot: a behaviour to follow, and situations to go to."""

from collections.abc import Mapping

from kurt2rt.channel.protocol.lesson_situations import situations_of
from kurt2rt.channel.protocol.requests import (
    BeAtRequest,
    PursueRequest,
    SeekLikeRequest,
    SeekRequest,
    SeekRlaRequest,
    SituationsRequest,
)
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.base import ClientBase
from kurt2rt.teacher.client.request_sender import facts_of


class GoalsMixin(ClientBase):
    """What the robot is to follow and to seek. Each raises NoAnswerError when nobody answers."""

    async def pursue(self, behaviour: str) -> Answer:
        """Follow another of the behaviours that the task teaches; lessons are about it from then on."""
        # It changes where a robot goes that drives: so a stop ends it, and what was seen is what he looked at.
        return await self._stopping.move(
            behaviour, lambda: self._asking.command(PursueRequest, moves=True, behaviour=behaviour)
        )

    async def situations(self) -> tuple[str, ...]:
        """The names of the situations that have one."""
        return await self._asking.told(SituationsRequest(), lambda response: situations_of(facts_of(response)))

    async def seek(self, name: str) -> Answer:
        """Go to a situation that has a name; the robot plans the way, and says when there is none."""
        return await self._stopping.move(name, lambda: self._asking.command(SeekRequest, moves=True, name=name))

    async def seek_rla(self, rla: int) -> Answer:
        """Go to the situation that an RLA of the mid level knows."""
        return await self._stopping.move(
            f"RLA {rla}", lambda: self._asking.command(SeekRlaRequest, moves=True, rla_id=rla)
        )

    async def seek_like(self, features: Mapping[str, float], tolerance: float) -> Answer:
        """Go to any situation in which these features of the mid level have these values, give or take `tolerance`."""
        wanted = tuple(features.items())
        return await self._stopping.move(
            "a goal",
            lambda: self._asking.command(SeekLikeRequest, moves=True, features=wanted, tolerance=tolerance),
        )

    async def stop_seeking(self) -> Answer:
        """No goal any more; the mid level commands as it did before."""
        return await self._stopping.move("no goal", lambda: self._asking.command(SeekRequest, moves=True, name=None))

    async def be_at(self, name: str) -> Answer:
        """The robot was set down at a situation that has a name."""
        return await self._asking.command(BeAtRequest, name=name)
