"""Generated worlds by name, such as `rooms-17`."""

import re

from simbridge.worlds.generator.rooms import room
from simbridge.worlds.generator.streets import streets
from simbridge.worlds.world_settings import WorldSettings

GENERATED = "rooms-N or streets-N with any whole number N up to 9 digits, such as rooms-17"
"""Valid names, for messages."""
_NAME = re.compile(r"(rooms|streets)-(0|[1-9]\d{0,8})", re.ASCII)


def generated(name: str) -> WorldSettings | None:
    """Return the world of this name, always the same; None if it is no name of a generated world."""
    match = _NAME.fullmatch(name)
    if match is None:
        return None
    return (room if match[1] == "rooms" else streets)(int(match[2]))
