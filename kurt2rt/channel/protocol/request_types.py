"""Base classes of requests, and the types of their fields, each with its check."""

from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, get_args, get_type_hints

from kurt2rt.channel.protocol.limits import (
    BOOT_BYTES,
    COMMAND_ID_BYTES,
    HIGHEST_SPEED_M_S,
    LARGEST_NUMBER,
    LONGEST_TEXT,
    LONGEST_WAY_M,
    MOST_GOAL_FEATURES,
    UPLOAD_ID_BYTES,
)
from kurt2rt.channel.protocol.schema import Bytes, Check, Float, Int, ManyOf, OneWord, OrNone, Row, Text
from kurt2rt.core.rla.rla import BASIC, MID

Boot = Annotated[bytes, Bytes(BOOT_BYTES)]
CommandId = Annotated[bytes, Bytes(COMMAND_ID_BYTES)]
UploadId = Annotated[bytes, Bytes(UPLOAD_ID_BYTES)]
Number = Annotated[int, Int(0, LARGEST_NUMBER)]
NumberOrNone = Annotated[int | None, OrNone(Int(0, LARGEST_NUMBER))]
Speed = Annotated[float, Float(HIGHEST_SPEED_M_S, "m/s")]
Way = Annotated[float, Float(LONGEST_WAY_M, "m")]
Angle = Annotated[float, Float(100.0, "rad")]
Name = Annotated[str, Text(LONGEST_TEXT, least=1)]
NameOrNone = Annotated[str | None, OrNone(Text(LONGEST_TEXT, least=1))]
Level = Annotated[str, OneWord((BASIC, MID))]
Features = Annotated[
    tuple[tuple[str, float], ...],
    ManyOf(Row((Text(LONGEST_TEXT, least=1), Float(1e6))), most=MOST_GOAL_FEATURES),
]


@dataclass(frozen=True, slots=True)
class Request:
    """Message to one path; its fields are the places of the body, in order."""

    path: ClassVar[str]
    depth: ClassVar[int] = 1
    """Deepest nesting of lists in the body."""


@dataclass(frozen=True, slots=True)
class StreamRequest(Request):
    """Message of a stream in which only the newest counts; OSCORE's sequence numbers give the order."""

    boot: Boot
    """Start of the robot program that it is meant for."""
    seen: Number
    """Tick of the newest state or answer that the device had."""


@dataclass(frozen=True, slots=True)
class CommandRequest(Request):
    """Command that is sent again until it is answered and counts once."""

    boot: Boot
    command_id: CommandId
    """Random id, equal in all copies of the command."""
    seen: Number
    """Tick of the newest state that the teacher had."""


def checks_of(kind: type[Request]) -> tuple[tuple[str, Check], ...]:
    """Return the name and the check of each field of a request, in the order of its body."""
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    return tuple((each.name, get_args(hints[each.name])[1]) for each in fields(kind))
