"""Where the robot is to go, and where it was set down."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.channel.protocol.requests.field_types import Name, NameOrNone, Number
from kurt2rt.channel.protocol.requests.limits import LONGEST_TEXT, MOST_GOAL_FEATURES
from kurt2rt.channel.protocol.requests.request import CommandRequest
from kurt2rt.channel.protocol.schema import Float, ManyOf, Row, Text

_FEATURE = Row((Text(LONGEST_TEXT, least=1), Float(1e6)))


@dataclass(frozen=True, slots=True)
class PursueRequest(CommandRequest):
    """Follow another taught behaviour; while a mid level commands, until it has finished."""

    path: ClassVar[str] = "/pursue"
    behaviour: Name


@dataclass(frozen=True, slots=True)
class SeekRequest(CommandRequest):
    """Go to a situation that has a name; None: seek nothing any more."""

    path: ClassVar[str] = "/seek"
    name: NameOrNone


@dataclass(frozen=True, slots=True)
class SeekRlaRequest(CommandRequest):
    """Go to the situation that an RLA of the mid level knows."""

    path: ClassVar[str] = "/seek/rla"
    rla_id: Number


@dataclass(frozen=True, slots=True)
class SeekLikeRequest(CommandRequest):
    """Go to any situation in which some features of the mid level are as wanted."""

    path: ClassVar[str] = "/seek/like"
    depth: ClassVar[int] = 3
    features: Annotated[tuple[tuple[str, float], ...], ManyOf(_FEATURE, most=MOST_GOAL_FEATURES)]
    """Names and values."""
    tolerance: Annotated[float, Float(1e6)]
    """How far each may be off."""


@dataclass(frozen=True, slots=True)
class BeAtRequest(CommandRequest):
    """The robot was set down at a place that has a name."""

    path: ClassVar[str] = "/here"
    name: Name
