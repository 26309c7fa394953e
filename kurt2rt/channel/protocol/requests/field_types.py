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
from kurt2rt.channel.protocol.schema import Octets, OneWord, OrNone, Real, Text, Whole
from kurt2rt.core.rla.rla import BASIC, MID

Boot = Annotated[bytes, Octets(BOOT_BYTES)]
CommandId = Annotated[bytes, Octets(COMMAND_ID_BYTES)]
Number = Annotated[int, Whole(0, LARGEST_NUMBER)]
TickOrNone = Annotated[int | None, OrNone(Whole(0, LARGEST_NUMBER))]
Speed = Annotated[float, Real(HIGHEST_SPEED_M_S, "m/s")]
Way = Annotated[float, Real(LONGEST_WAY_M, "m")]
Angle = Annotated[float, Real(100.0, "rad")]
Name = Annotated[str, Text(LONGEST_TEXT, least=1)]
NameOrNone = Annotated[str | None, OrNone(Text(LONGEST_TEXT, least=1))]
Level = Annotated[str, OneWord((BASIC, MID))]
