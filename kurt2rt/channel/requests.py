"""What a teacher's device can ask of the robot: one request per path, and the checks of its fields."""

from dataclasses import dataclass, fields
from typing import Annotated, ClassVar, get_args, get_type_hints

from kurt2rt.channel.schema import Check, Flag, ManyOf, Octets, OneOf, OneWord, OrNone, Real, Row, Text, Whole
from kurt2rt.rla.rla import BASIC, MID, Phase

VERSION = 4
"""Of the wire contract: what /hello and /state hold. A device refuses another one and says what to do."""
BOOT_BYTES = 4
COMMAND_ID_BYTES = 8
HIGHEST_SPEED_M_S = 2.0
LONGEST_WAY_M = 100.0
LONGEST_TEXT = 64
MOST_LESSONS = 20
MOST_GOAL_FEATURES = 16
MOST_SITUATIONS = 250
"""Of names that are told: so many of the longest ones fit into one answer."""
LARGEST_NUMBER = 2**53
"""Of ticks, sequence numbers and RLAs: the largest that every language holds exactly."""
LONGEST_BEHAVIOUR_TICKS = 60_000
"""Ten minutes at 100 Hz."""

_Boot = Annotated[bytes, Octets(BOOT_BYTES)]
_CommandId = Annotated[bytes, Octets(COMMAND_ID_BYTES)]
_Number = Annotated[int, Whole(0, LARGEST_NUMBER)]
_TickOrNone = Annotated[int | None, OrNone(Whole(0, LARGEST_NUMBER))]
_Speed = Annotated[float, Real(HIGHEST_SPEED_M_S, "m/s")]
_Way = Annotated[float, Real(LONGEST_WAY_M, "m")]
_Angle = Annotated[float, Real(100.0, "rad")]
_Name = Annotated[str, Text(LONGEST_TEXT, least=1)]
_NameOrNone = Annotated[str | None, OrNone(Text(LONGEST_TEXT, least=1))]
_FEATURE = Row((Text(LONGEST_TEXT, least=1), Real(1e6)))
_Level = Annotated[str, OneWord((BASIC, MID))]


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

    boot: _Boot
    """Start of the robot program that it was meant for."""
    seen: _Number
    """Tick of the newest sign of the robot that the device had, a picture or an answer.

    Which of two messages is the newer one OSCORE tells: each has a number of its own.
    """


@dataclass(frozen=True, slots=True)
class CommandRequest(Request):
    """One that is sent again until it is answered and counts once."""

    boot: _Boot
    command_id: _CommandId
    """Random, one per command, the same each time it is sent."""
    seen: _Number
    """Tick of the newest picture that the teacher had when he acted."""


@dataclass(frozen=True, slots=True)
class HelloRequest(Request):
    """What robot is this?"""

    path: ClassVar[str] = "/hello"


@dataclass(frozen=True, slots=True)
class WatchRequest(StreamRequest):
    """The teacher is there and sees the robot."""

    path: ClassVar[str] = "/watch"


@dataclass(frozen=True, slots=True)
class DriveRequest(StreamRequest):
    """The teacher drives by hand."""

    path: ClassVar[str] = "/drive"
    hold: _Number
    """Grows with each press."""
    left_m_s: _Speed
    right_m_s: _Speed


@dataclass(frozen=True, slots=True)
class StopRequest(Request):
    """Stand. Needs neither a boot id nor a fresh picture."""

    path: ClassVar[str] = "/stop"
    command_id: _CommandId
    hold: _TickOrNone = None
    """The press that is let go, so that a copy that comes late does not end the next one; None: everything."""


@dataclass(frozen=True, slots=True)
class BehaviourRequest(CommandRequest):
    """Run an action of the repertoire for a time."""

    path: ClassVar[str] = "/behaviour"
    action: _Name
    ticks: Annotated[int, Whole(1, LONGEST_BEHAVIOUR_TICKS)]


@dataclass(frozen=True, slots=True)
class AnswerRequest(CommandRequest):
    """Answer a situation (phase 1)."""

    path: ClassVar[str] = "/answer"
    may_lack: ClassVar[int] = 2
    action: _Name
    """What is right there: an action for the basic level, a taught behaviour for the mid level."""
    decision_tick: _TickOrNone
    """The situation of which tick; None: the present one. So it is with the next three."""
    level: _Level = BASIC
    """Whose situation it is."""
    beside: Annotated[bool, Flag()] = False
    """Possible too, beside what the mid level knows there already."""


@dataclass(frozen=True, slots=True)
class CorrectRequest(CommandRequest):
    """Another action is right (phase 2)."""

    path: ClassVar[str] = "/correct"
    may_lack: ClassVar[int] = 1
    action: _Name
    decision_tick: _TickOrNone
    level: _Level = BASIC
    """Whose decision was wrong."""


@dataclass(frozen=True, slots=True)
class RewardRequest(CommandRequest):
    """Praise (+1) or blame (-1)."""

    path: ClassVar[str] = "/reward"
    value: Annotated[int, OneOf((1, -1))]
    decision_tick: _TickOrNone


@dataclass(frozen=True, slots=True)
class AppraiseRequest(CommandRequest):
    """Teach the critic what a situation was worth (phase 4)."""

    path: ClassVar[str] = "/appraise"
    appraisal: _Name
    """A name of the critic's repertoire."""
    decision_tick: _TickOrNone


@dataclass(frozen=True, slots=True)
class ReplaceRequest(CommandRequest):
    """Give one RLA another action."""

    path: ClassVar[str] = "/replace"
    rla_id: _Number
    action: _Name


@dataclass(frozen=True, slots=True)
class DeleteRequest(CommandRequest):
    """Delete one RLA."""

    path: ClassVar[str] = "/delete"
    rla_id: _Number


@dataclass(frozen=True, slots=True)
class UndoRequest(CommandRequest):
    """Take a lesson back."""

    path: ClassVar[str] = "/undo"
    lesson: _NameOrNone
    """Its command id in the journal; None: the last one that still stands."""


@dataclass(frozen=True, slots=True)
class PhaseRequest(CommandRequest):
    """Another training phase."""

    path: ClassVar[str] = "/phase"
    phase: Annotated[Phase, OneOf(tuple(each.value for each in Phase), Phase)]


@dataclass(frozen=True, slots=True)
class PursueRequest(CommandRequest):
    """Follow another taught behaviour; while a mid level commands, until it has finished."""

    path: ClassVar[str] = "/pursue"
    behaviour: _Name


@dataclass(frozen=True, slots=True)
class NameRequest(CommandRequest):
    """Give the mid level's situation a name, so that it can be a goal."""

    path: ClassVar[str] = "/name"
    name: _Name
    decision_tick: _TickOrNone
    """The situation of which tick; None: the present one."""


@dataclass(frozen=True, slots=True)
class SeekRequest(CommandRequest):
    """Go to a situation that has a name; None: seek nothing any more."""

    path: ClassVar[str] = "/seek"
    name: _NameOrNone


@dataclass(frozen=True, slots=True)
class SeekRlaRequest(CommandRequest):
    """Go to the situation that an RLA of the mid level knows."""

    path: ClassVar[str] = "/seek/rla"
    rla_id: _Number


@dataclass(frozen=True, slots=True)
class SeekLikeRequest(CommandRequest):
    """Go to any situation in which some features of the mid level are as wanted."""

    path: ClassVar[str] = "/seek/like"
    depth: ClassVar[int] = 3
    features: Annotated[tuple[tuple[str, float], ...], ManyOf(_FEATURE, most=MOST_GOAL_FEATURES)]
    """Names and values."""
    tolerance: Annotated[float, Real(1e6)]
    """How far each may be off."""


@dataclass(frozen=True, slots=True)
class BeAtRequest(CommandRequest):
    """The robot was set down at a place that has a name."""

    path: ClassVar[str] = "/here"
    name: _Name


@dataclass(frozen=True, slots=True)
class SituationsRequest(Request):
    """The situations that have a name."""

    path: ClassVar[str] = "/situations"


@dataclass(frozen=True, slots=True)
class SessionRequest(CommandRequest):
    """Teaching begins under a name, or ends (None)."""

    path: ClassVar[str] = "/session"
    name: _NameOrNone


@dataclass(frozen=True, slots=True)
class ResumeRequest(CommandRequest):
    """Drive again after a stop."""

    path: ClassVar[str] = "/resume"


@dataclass(frozen=True, slots=True)
class TakeRequest(CommandRequest):
    """Be the teacher from now on."""

    path: ClassVar[str] = "/take"


@dataclass(frozen=True, slots=True)
class ReleaseRequest(CommandRequest):
    """Be the teacher no longer."""

    path: ClassVar[str] = "/release"
    to: _NameOrNone
    """Who is the teacher next; None: whoever takes it."""


@dataclass(frozen=True, slots=True)
class SaveRequest(CommandRequest):
    """A copy of the knowledge on the robot."""

    path: ClassVar[str] = "/save"
    label: Annotated[str, Text(LONGEST_TEXT)]


@dataclass(frozen=True, slots=True)
class ExportRequest(CommandRequest):
    """The RLAs as a readable table on the robot."""

    path: ClassVar[str] = "/export"


@dataclass(frozen=True, slots=True)
class LessonsRequest(Request):
    """The newest lessons."""

    path: ClassVar[str] = "/lessons"
    count: Annotated[int, Whole(0, MOST_LESSONS)]


@dataclass(frozen=True, slots=True)
class HealthRequest(Request):
    """How the robot's program, its bus, its disk and its machine are."""

    path: ClassVar[str] = "/health"


@dataclass(frozen=True, slots=True)
class WorldRequest(Request):
    """The simulated world."""

    path: ClassVar[str] = "/world"


@dataclass(frozen=True, slots=True)
class MoveWallRequest(CommandRequest):
    """Shift a wall of the simulated world."""

    path: ClassVar[str] = "/world/move"
    name: _Name
    dx_m: _Way
    dy_m: _Way


@dataclass(frozen=True, slots=True)
class PlaceRequest(CommandRequest):
    """Put the simulated robot down elsewhere."""

    path: ClassVar[str] = "/world/place"
    x_m: _Way
    y_m: _Way
    heading_rad: _Angle


REQUESTS: tuple[type[Request], ...] = (
    HelloRequest,
    WatchRequest,
    DriveRequest,
    StopRequest,
    BehaviourRequest,
    AnswerRequest,
    CorrectRequest,
    RewardRequest,
    AppraiseRequest,
    ReplaceRequest,
    DeleteRequest,
    UndoRequest,
    PhaseRequest,
    PursueRequest,
    NameRequest,
    SeekRequest,
    SeekRlaRequest,
    SeekLikeRequest,
    BeAtRequest,
    SituationsRequest,
    SessionRequest,
    ResumeRequest,
    TakeRequest,
    ReleaseRequest,
    SaveRequest,
    ExportRequest,
    LessonsRequest,
    HealthRequest,
    WorldRequest,
    MoveWallRequest,
    PlaceRequest,
)


def checks_of(kind: type[Request]) -> tuple[tuple[str, Check], ...]:
    """The fields of a request in the order of its body, each with the check it has to pass."""
    hints = get_type_hints(kind, include_extras=True)
    return tuple((each.name, get_args(hints[each.name])[1]) for each in fields(kind))
