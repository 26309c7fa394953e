"""What moves the robot, or has it stand."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.channel.protocol.requests.field_types import CommandId, Name, Number, Speed, TickOrNone
from kurt2rt.channel.protocol.requests.limits import LONGEST_BEHAVIOUR_TICKS
from kurt2rt.channel.protocol.requests.request import CommandRequest, Request, StreamRequest
from kurt2rt.channel.protocol.schema import Int


@dataclass(frozen=True, slots=True)
class WatchRequest(StreamRequest):
    """The teacher is there and sees the robot."""

    path: ClassVar[str] = "/watch"


@dataclass(frozen=True, slots=True)
class DriveRequest(StreamRequest):
    """The teacher drives by hand."""

    path: ClassVar[str] = "/drive"
    hold: Number
    """Grows with each press."""
    left_m_s: Speed
    right_m_s: Speed


@dataclass(frozen=True, slots=True)
class StopRequest(Request):
    """Stand. Needs neither a boot id nor a fresh picture."""

    path: ClassVar[str] = "/stop"
    command_id: CommandId
    hold: TickOrNone = None
    """The press that is let go, so that a copy that comes late does not end the next one; None: everything."""


@dataclass(frozen=True, slots=True)
class BehaviourRequest(CommandRequest):
    """Run an action of the repertoire for a time."""

    path: ClassVar[str] = "/behaviour"
    action: Name
    ticks: Annotated[int, Int(1, LONGEST_BEHAVIOUR_TICKS)]


@dataclass(frozen=True, slots=True)
class ResumeRequest(CommandRequest):
    """Drive again after a stop."""

    path: ClassVar[str] = "/resume"
