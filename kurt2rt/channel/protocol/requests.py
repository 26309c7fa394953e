"""Requests of a teacher's device: one class for each path of the robot, with a check for each field."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, TypeVar, dataclass_transform

from kurt2rt.channel.protocol.limits import (
    FASTEST,
    LARGEST_NUMBER,
    LONGEST_BEHAVIOUR_TICKS,
    LONGEST_FILE_NAME,
    LONGEST_TEXT,
    MOST_LESSONS,
    SHA256_BYTES,
    SLOWEST_PERCENT,
    UPLOAD_PART_BYTES,
)
from kurt2rt.channel.protocol.request_types import (
    Angle,
    Boot,
    CommandId,
    CommandRequest,
    Features,
    Level,
    Name,
    NameOrNone,
    Number,
    NumberOrNone,
    Request,
    Speed,
    StreamRequest,
    UploadId,
    Way,
)
from kurt2rt.channel.protocol.schema import Bytes, BytesUpTo, Flag, Float, Int, ManyOf, OneOf, OneWord, Text
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import MOST_SEGMENTS

TABLE, PACKAGE = "table", "package"
"""Forms of an export: CSV, and the archive of `kurt2rt knowledge export`."""

REQUESTS: list[type[Request]] = []
"""All requests, in the order in which the robot lists its paths."""

_RequestT = TypeVar("_RequestT", bound=Request)


@dataclass_transform(frozen_default=True)
def _at(path: str, *, depth: int = 1) -> Callable[[type[_RequestT]], type[_RequestT]]:
    """Return a decorator that makes a class the request of a path."""

    def register(kind: type[_RequestT]) -> type[_RequestT]:
        request = dataclass(frozen=True, slots=True)(kind)
        request.path, request.depth = path, depth
        REQUESTS.append(request)
        return request

    return register


@_at("/hello")
class HelloRequest(Request):
    """Query of the robot's description."""


@_at("/watch")
class WatchRequest(StreamRequest):
    """Sign that the teacher is there and sees the robot."""


@_at("/drive")
class DriveRequest(StreamRequest):
    """Speeds of the wheels while the teacher drives by hand."""

    press_id: Number
    """Number of the press; it grows with each press."""
    left_m_s: Speed
    right_m_s: Speed


@_at("/hold")
class HoldRequest(StreamRequest):
    """Action that drives and teaches while the teacher holds it (hold to correct)."""

    press_id: Number
    """Number of the press, in one sequence with those of `/drive`."""
    action: Name
    """Action of the repertoire."""


@_at("/stop")
class StopRequest(Request):
    """Stop. It needs neither a boot id nor a fresh state."""

    command_id: CommandId
    press_id: NumberOrNone = None
    """Press that ends, so that a late copy does not end the next one; None: everything. After a press of `/hold` the
    robot drives on by its RLAs."""


@_at("/behaviour")
class BehaviourRequest(CommandRequest):
    """Run an action of the repertoire for a time."""

    action: Name
    ticks: Annotated[int, Int(1, LONGEST_BEHAVIOUR_TICKS)]


@_at("/answer")
class AnswerRequest(CommandRequest):
    """Answer a situation (phase 1)."""

    action: Name
    """Right action; at the mid level a taught behaviour."""
    decision_tick: NumberOrNone
    """Tick of the situation that is meant, here and in the other lessons; None: the present one."""
    level: Level = BASIC
    """Level of the situation."""
    alternative: Annotated[bool, Flag()] = False
    """Add the behaviour to those that the mid level knows for this situation."""


@_at("/correct")
class CorrectRequest(CommandRequest):
    """Replace a decided action by another one (phase 2)."""

    action: Name
    decision_tick: NumberOrNone
    level: Level = BASIC
    """Level of the wrong decision."""
    late: Annotated[bool, Flag()] = False
    """Give it to the decision that this teacher reacted to, before the named state by their known delay."""


@_at("/shown", depth=2)
class ShownRequest(CommandRequest):
    """Teach segments of the newest drive by hand."""

    press_id: Number
    """Press that was driven."""
    segments: Annotated[tuple[int, ...], ManyOf(Int(0, LARGEST_NUMBER), most=MOST_SEGMENTS)]
    """Indexes of the segments that are right."""


@_at("/reward")
class RewardRequest(CommandRequest):
    """Reward a decision (phase 3)."""

    value: Annotated[int, OneOf((1, -1))]
    decision_tick: NumberOrNone


@_at("/appraise")
class AppraiseRequest(CommandRequest):
    """Teach the critic the value of a situation (phase 4)."""

    appraisal: Name
    """Name in the critic's repertoire."""
    decision_tick: NumberOrNone


@_at("/replace")
class ReplaceRequest(CommandRequest):
    """Give one RLA another action."""

    rla_id: Number
    action: Name


@_at("/delete")
class DeleteRequest(CommandRequest):
    """Delete one RLA."""

    rla_id: Number


@_at("/undo")
class UndoRequest(CommandRequest):
    """Undo a lesson."""

    lesson: NameOrNone
    """Command id in the journal; None: the last lesson that stands."""


@_at("/phase")
class PhaseRequest(CommandRequest):
    """Choose the training phase."""

    phase: Annotated[Phase, OneOf(tuple(each.value for each in Phase), Phase)]


@_at("/lesson/speed")
class LessonSpeedRequest(CommandRequest):
    """Set the speed of lessons."""

    percent: Annotated[int, Int(SLOWEST_PERCENT, 100)]
    """Speed of actions in phases 1 and 2, in per cent of their own."""


@_at("/pursue")
class PursueRequest(CommandRequest):
    """Follow another taught behaviour; under a mid level, until that behaviour has finished."""

    behaviour: Name


@_at("/name")
class NameRequest(CommandRequest):
    """Give the mid level's situation a name, so that it can be a goal."""

    name: Name
    decision_tick: NumberOrNone


@_at("/seek")
class SeekRequest(CommandRequest):
    """Go to a named situation; None: drop the goal."""

    name: NameOrNone


@_at("/seek/rla")
class SeekRlaRequest(CommandRequest):
    """Go to the situation that an RLA of the mid level knows."""

    rla_id: Number


@_at("/seek/like", depth=3)
class SeekLikeRequest(CommandRequest):
    """Go to any situation with these values of some mid-level features."""

    features: Features
    """Names and values."""
    tolerance: Annotated[float, Float(1e6)]
    """Largest difference of each value, in the feature's unit."""


@_at("/here")
class SetLocationRequest(CommandRequest):
    """Tell the robot that it was put down at a named situation."""

    name: Name


@_at("/situations")
class SituationsRequest(Request):
    """Query of the named situations."""


@_at("/session")
class SessionRequest(CommandRequest):
    """Begin a session under a name; None: end it."""

    name: NameOrNone


@_at("/resume")
class ResumeRequest(CommandRequest):
    """Drive again after a stop."""


@_at("/take")
class TakeRequest(CommandRequest):
    """Become the robot's teacher."""


@_at("/release")
class HandOverRequest(CommandRequest):
    """Stop being the robot's teacher."""

    to: NameOrNone
    """Next teacher; None: the first one that takes the robot."""


@_at("/save")
class SaveRequest(CommandRequest):
    """Copy the knowledge on the robot."""

    label: Annotated[str, Text(LONGEST_TEXT)]


@_at("/export")
class ExportRequest(CommandRequest):
    """Write the RLAs as a table on the robot, or all knowledge as one file to give away."""

    form: Annotated[str, OneWord((TABLE, PACKAGE))] = TABLE


@_at("/file")
class FileRequest(Request):
    """Query of one part of a file that `/save` or `/export` of this start made."""

    name: Annotated[str, Text(LONGEST_FILE_NAME, least=1)]
    offset: Number
    """Position of the part's first byte in the file."""


@_at("/exam")
class ExamRequest(CommandRequest):
    """Examine a copy of the present knowledge in simulation, while the robot goes on."""


@_at("/exam/standing")
class ExamStatusRequest(Request):
    """Query of the exam's status."""


@_at("/lessons")
class LessonsRequest(Request):
    """Query of the newest lessons."""

    count: Annotated[int, Int(0, MOST_LESSONS)]


@_at("/health")
class HealthRequest(Request):
    """Query of the health of the robot's program, bus, disk and machine."""


@_at("/why")
class WhyRequest(Request):
    """Query of the facts behind the newest decision."""


@_at("/world")
class WorldRequest(Request):
    """Query of the simulated world."""


@_at("/world/move")
class MoveWallRequest(CommandRequest):
    """Shift a wall of the simulated world."""

    name: Name
    dx_m: Way
    dy_m: Way


@_at("/world/place")
class PlaceRequest(CommandRequest):
    """Put the simulated robot down elsewhere."""

    x_m: Way
    y_m: Way
    heading_rad: Angle


@_at("/world/start")
class BackToStartRequest(CommandRequest):
    """Put the simulated robot down at the start of its run."""


@_at("/simulation")
class SimulationRequest(Request):
    """Query of the simulated world and task, and of those to choose from."""


@_at("/simulation/run")
class NextRunRequest(CommandRequest):
    """End this run and begin the next one, in which the robot stands until GO."""

    world: NameOrNone
    """None: the present world."""
    task: NameOrNone
    """None: the present task."""
    fresh: Annotated[bool, Flag()]
    """Begin with an empty knowledge file; the present one is archived."""


@_at("/simulation/speed")
class SpeedRequest(CommandRequest):
    """Set the speed of robot time."""

    times: Annotated[int, Int(1, FASTEST)]
    """Robot seconds in one second."""


@_at("/upload")
class UploadRequest(Request):
    """One part of a file, in order; a repeated part changes nothing."""

    boot: Boot
    upload: UploadId
    """Random id, equal in all parts of one file."""
    offset: Number
    """Position of the part's first byte in the file; 0 begins the file."""
    part: Annotated[bytes, BytesUpTo(UPLOAD_PART_BYTES)]


@_at("/load")
class LoadRequest(CommandRequest):
    """Begin the next run with the uploaded knowledge, in simulation."""

    upload: UploadId
    sha256: Annotated[bytes, Bytes(SHA256_BYTES)]
    """SHA-256 of the whole file."""
