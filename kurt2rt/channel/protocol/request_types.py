"""Base classes of requests, and the types of their fields, each with its check."""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from kurt2rt.channel.protocol.limits import BOOT_BYTES, COMMAND_ID_BYTES, LONGEST_WAY_M, UPLOAD_ID_BYTES
from kurt2rt.core.message_fields import Bytes, Float, Number
from kurt2rt.core.teaching.commands import Single, Stream

Boot = Annotated[bytes, Bytes(BOOT_BYTES)]
CommandId = Annotated[bytes, Bytes(COMMAND_ID_BYTES)]
UploadId = Annotated[bytes, Bytes(UPLOAD_ID_BYTES)]
Way = Annotated[float, Float(LONGEST_WAY_M, "m")]
Angle = Annotated[float, Float(100.0, "rad")]


@dataclass(frozen=True, slots=True)
class Request:
    """Message to one path; its fields are the places of the body, in order."""

    path: ClassVar[str]


@dataclass(frozen=True, slots=True)
class StreamRequest(Request):
    """Message of a stream in which only the newest counts; OSCORE's sequence numbers give the order."""

    boot: Boot
    """Start of the robot program that it is meant for."""
    command: Stream
    """Command without its teacher, whom the robot knows by the key; its fields follow in the body."""


@dataclass(frozen=True, slots=True)
class CommandRequest(Request):
    """Command that is sent again until it is answered and counts once."""

    moves: ClassVar[bool] = False
    """True if a standing robot may drive after it: the state that the teacher saw must not be older than 1 s."""
    boot: Boot
    command_id: CommandId
    """Random id, equal in all copies of the command."""
    seen: Number
    """Tick of the newest state that the teacher had."""


@dataclass(frozen=True, slots=True)
class TickRequest(CommandRequest):
    """Command for the next tick."""

    command: Single
    """Command without its teacher, whose id lacks the teacher's name; its fields follow in the body."""


def stream_request(kind: type[Stream], boot: bytes, **own: Any) -> StreamRequest:
    """Return the request of a message of a stream; `own` are the fields of the command with a check."""
    return StreamRequest(boot, kind(teacher="", **own))


def tick_request(kind: type[Single], boot: bytes, command_id: bytes, seen: int, **own: Any) -> TickRequest:
    """Return the request of a command for the next tick; `own` are the fields of the command with a check."""
    # Some commands do not depend on the state that their teacher saw.
    if hasattr(kind, "seen_tick"):
        own["seen_tick"] = seen
    return TickRequest(boot, command_id, seen, kind(command_id=command_id.hex(), teacher="", **own))
