"""What only asks."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.channel.protocol.requests.field_types import Number
from kurt2rt.channel.protocol.requests.limits import LONGEST_FILE_NAME, MOST_LESSONS
from kurt2rt.channel.protocol.requests.request import Request
from kurt2rt.channel.protocol.schema import Int, Text


@dataclass(frozen=True, slots=True)
class HelloRequest(Request):
    """What robot is this?"""

    path: ClassVar[str] = "/hello"


@dataclass(frozen=True, slots=True)
class LessonsRequest(Request):
    """The newest lessons."""

    path: ClassVar[str] = "/lessons"
    count: Annotated[int, Int(0, MOST_LESSONS)]


@dataclass(frozen=True, slots=True)
class SituationsRequest(Request):
    """The situations that have a name."""

    path: ClassVar[str] = "/situations"


@dataclass(frozen=True, slots=True)
class HealthRequest(Request):
    """How the robot's program, its bus, its disk and its machine are."""

    path: ClassVar[str] = "/health"


@dataclass(frozen=True, slots=True)
class WhyRequest(Request):
    """What the newest decision rested on."""

    path: ClassVar[str] = "/why"


@dataclass(frozen=True, slots=True)
class FileRequest(Request):
    """One part of a file that `/save` or `/export` of this start made."""

    path: ClassVar[str] = "/file"
    name: Annotated[str, Text(LONGEST_FILE_NAME, least=1)]
    offset: Number
    """Position of the part's first byte in the file."""
