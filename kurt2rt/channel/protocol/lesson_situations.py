"""The situations that have a name, in the list of a teacher's device."""

from collections.abc import Mapping
from typing import Any

from kurt2rt.channel.protocol.requests import LONGEST_TEXT, MOST_SITUATIONS
from kurt2rt.channel.protocol.schema import ManyOf, Text, WireError

_NAMES = ManyOf(Text(LONGEST_TEXT, least=1), most=MOST_SITUATIONS)


def situations_of(body: Mapping[str, Any]) -> tuple[str, ...]:
    """The names in a decoded body. Raises WireError."""
    if "situations" not in body:
        raise WireError("the robot's answer has no situations")
    names: tuple[str, ...] = _NAMES("situations", body["situations"])
    return names
