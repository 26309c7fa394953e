"""Client that sends commands to a robot."""

from collections.abc import Callable
from typing import Any

from kurt2rt.channel.protocol.request_types import Request
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.observer_client import ObserverClient


class CommandClient(ObserverClient):
    """Observer that can also command; base of the groups of commands of a `TeacherClient`."""

    async def _command(self, kind: Callable[..., Request], *, moves: bool = False, **fields: Any) -> Answer:
        return await self._open.sender.command(kind, moves=moves, **fields)

    async def _move(self, label: str, kind: Callable[..., Request], /, **fields: Any) -> Answer:
        """Send a command that may set the robot in motion; a stop before its answer ends it."""
        return await self._open.stops.move(label, lambda: self._command(kind, moves=True, **fields))
