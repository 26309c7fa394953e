"""Client that sends commands to a robot."""

from typing import Any

from kurt2rt.channel.protocol.request_types import CommandRequest
from kurt2rt.core.teaching.commands import Single
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.observer_client import ObserverClient


class CommandClient(ObserverClient):
    """Observer that can also command; base of the groups of commands of a `TeacherClient`."""

    async def _command(self, kind: type[Single | CommandRequest], *, moves: bool = False, **fields: Any) -> Answer:
        return await self._open.sender.command(kind, moves=moves, **fields)

    async def _move(self, label: str, kind: type[Single | CommandRequest], /, **fields: Any) -> Answer:
        """Send a command that may set the robot in motion; a stop before its answer ends it."""
        return await self._open.stops.move(label, lambda: self._command(kind, moves=True, **fields))
