"""The types of fields that several requests share, each with the check it has to pass."""

from typing import Annotated

from kurt2rt.channel.protocol.requests.limits import (
    BOOT_BYTES,
    COMMAND_ID_BYTES,
    HIGHEST_SPEED_M_S,
    LARGEST_NUMBER,
    LONGEST_TEXT,
    LONGEST_WAY_M,
)
from kurt2rt.channel.protocol.schema import Bytes, Float, Int, OneWord, OrNone, Text
from kurt2rt.core.rla.rla import BASIC, MID

Boot = Annotated[bytes, Bytes(BOOT_BYTES)]
CommandId = Annotated[bytes, Bytes(COMMAND_ID_BYTES)]
Number = Annotated[int, Int(0, LARGEST_NUMBER)]
TickOrNone = Annotated[int | None, OrNone(Int(0, LARGEST_NUMBER))]
Speed = Annotated[float, Float(HIGHEST_SPEED_M_S, "m/s")]
Way = Annotated[float, Float(LONGEST_WAY_M, "m")]
Angle = Annotated[float, Float(100.0, "rad")]
Name = Annotated[str, Text(LONGEST_TEXT, least=1)]
NameOrNone = Annotated[str | None, OrNone(Text(LONGEST_TEXT, least=1))]
Level = Annotated[str, OneWord((BASIC, MID))]
