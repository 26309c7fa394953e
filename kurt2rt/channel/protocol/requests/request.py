"""What every request is, and the checks that their fields share."""

from dataclasses import dataclass
from typing import ClassVar

from kurt2rt.channel.protocol.requests.field_types import Boot, CommandId, Number


@dataclass(frozen=True, slots=True)
class Request:
    """What comes to a path. Its fields are the body's, in their order."""

    path: ClassVar[str]
    may_lack: ClassVar[int] = 0
    """How many of its last fields a device of an older version leaves out; their defaults stand then."""
    depth: ClassVar[int] = 1
    """How deep lists are nested in its body: nearly all are flat."""


@dataclass(frozen=True, slots=True)
class StreamRequest(Request):
    """One of a stream of which only the newest counts."""

    boot: Boot
    """Start of the robot program that it was meant for."""
    seen: Number
    """Tick of the newest sign of the robot that the device had, a picture or an answer.

    Which of two messages is the newer one OSCORE tells: each has a number of its own.
    """


@dataclass(frozen=True, slots=True)
class CommandRequest(Request):
    """One that is sent again until it is answered and counts once."""

    boot: Boot
    command_id: CommandId
    """Random, one per command, the same each time it is sent."""
    seen: Number
    """Tick of the newest picture that the teacher had when he acted."""
