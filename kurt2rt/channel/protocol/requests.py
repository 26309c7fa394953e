"""Requests that are no commands for the tick: one class for each path of the robot, with a check for each field."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, ClassVar, TypeVar, dataclass_transform

from kurt2rt.channel.protocol.limits import FASTEST, LONGEST_FILE_NAME, MOST_LESSONS, SHA256_BYTES, UPLOAD_PART_BYTES
from kurt2rt.channel.protocol.request_types import (
    Angle,
    Boot,
    CommandId,
    CommandRequest,
    Request,
    UploadId,
    Way,
)
from kurt2rt.core.message_fields import LONGEST_TEXT, Bytes, BytesUpTo, Int, Name, Number, OneOf, Text, Truth

TABLE, PACKAGE = "table", "package"
"""Forms of an export: CSV, and the archive of `kurt2rt knowledge export`."""

REQUESTS: list[type[Request]] = []
"""All of them, in the order in which the robot lists its paths."""

_RequestT = TypeVar("_RequestT", bound=Request)


@dataclass_transform(frozen_default=True)
def _at(path: str) -> Callable[[type[_RequestT]], type[_RequestT]]:
    """Return a decorator that makes a class the request of a path."""

    def register(kind: type[_RequestT]) -> type[_RequestT]:
        request = dataclass(frozen=True, slots=True)(kind)
        request.path = path
        REQUESTS.append(request)
        return request

    return register


@_at("/hello")
class HelloRequest(Request):
    """Query of the robot's description."""


@_at("/stop")
class StopRequest(Request):
    """Stop. It needs neither a boot id nor a fresh state."""

    command_id: CommandId
    press_id: Number | None = None
    """Press that ends, so that a late copy does not end the next one; None: everything. After a press of `/hold` the
    robot drives on by its RLAs."""


@_at("/situations")
class SituationsRequest(Request):
    """Query of the named situations."""


@_at("/save")
class SaveRequest(CommandRequest):
    """Copy the knowledge on the robot."""

    label: Annotated[str, Text(LONGEST_TEXT)] = ""
    """Part of the copy's name."""


@_at("/export")
class ExportRequest(CommandRequest):
    """Write the RLAs as a table on the robot, or all knowledge as one file to give away."""

    form: Annotated[str, OneOf((TABLE, PACKAGE))] = TABLE


@_at("/file")
class FileRequest(Request):
    """Query of one part of a file that `/save` or `/export` of this start made."""

    name: Annotated[str, Text(LONGEST_FILE_NAME, least=1)]
    offset: Number
    """Position of the part's first byte in the file."""


@_at("/exam")
class ExamRequest(CommandRequest):
    """Examine a copy of the present knowledge in simulation, while the robot goes on; /exam/standing has the result."""


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

    moves: ClassVar[bool] = True
    x_m: Way
    y_m: Way
    heading_rad: Angle


@_at("/world/start")
class BackToStartRequest(CommandRequest):
    """Put the simulated robot down at the start of its run."""

    moves: ClassVar[bool] = True


@_at("/simulation")
class SimulationRequest(Request):
    """Query of the simulated world and task, and of those to choose from."""


@_at("/simulation/run")
class NextRunRequest(CommandRequest):
    """End this run and begin the next one, in which the robot stands until GO."""

    world: Name | None
    """None: the present world."""
    task: Name | None
    """None: the present task."""
    fresh: Truth
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
