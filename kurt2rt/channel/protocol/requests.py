"""Requests that are no commands for the tick: one class for each path of the robot, with a check for each field."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, TypeVar, dataclass_transform

from kurt2rt.channel.protocol.limits import (
    BOOT_BYTES,
    COMMAND_ID_BYTES,
    FASTEST,
    LONGEST_FILE_NAME,
    LONGEST_WAY_M,
    MOST_LESSONS,
    SHA256_BYTES,
    UPLOAD_ID_BYTES,
    UPLOAD_PART_BYTES,
)
from kurt2rt.core.message_fields import LONGEST_TEXT, Bytes, BytesUpTo, Float, Int, Name, Number, OneOf, Text, Truth
from kurt2rt.core.teaching.commands import Single, Stream

Boot = Annotated[bytes, Bytes(BOOT_BYTES)]
CommandId = Annotated[bytes, Bytes(COMMAND_ID_BYTES)]
UploadId = Annotated[bytes, Bytes(UPLOAD_ID_BYTES)]
Way = Annotated[float, Float(LONGEST_WAY_M, "m")]
Angle = Annotated[float, Float(100.0, "rad")]


@dataclass(frozen=True, slots=True)
class Request:
    """Base of all requests to the robot: a message to one path, whose body has its fields in order."""

    path: ClassVar[str]


@dataclass(frozen=True, slots=True)
class StreamRequest(Request):
    """Message of a stream in which only the newest counts; OSCORE's sequence numbers give the order."""

    boot: Boot
    """Start of the robot program that it is meant for."""
    command: Stream
    """Command without its teacher, whom the robot knows by the key; its fields follow in the body."""


@dataclass(frozen=True, slots=True)
class CommandRequest(Request):
    """Command that is sent again until it is answered and counts once."""

    moves: ClassVar[bool] = False
    """True if a standing robot may drive after it: the state that the teacher saw must not be older than 1 s."""
    typed: ClassVar[tuple[str, str] | None] = None
    """Form and meaning of its line in a terminal, for the help; None if the terminal tells it itself."""
    boot: Boot
    command_id: CommandId
    """Random id, equal in all copies of the command."""
    seen: Number
    """Tick of the newest state that the teacher had."""


@dataclass(frozen=True, slots=True)
class TickRequest(CommandRequest):
    """Request with a command that goes to the inbox and is carried out in the next tick."""

    command: Single
    """Command without its teacher, whose id lacks the teacher's name; its fields follow in the body."""


def stream_request(kind: type[Stream], boot: bytes, **own: Any) -> StreamRequest:
    """Return the request of a message of a stream; `own` are the fields of the command with a check."""
    return StreamRequest(boot, kind(teacher="", **own))


def tick_request(kind: type[Single], boot: bytes, command_id: bytes, seen: int, **own: Any) -> TickRequest:
    """Return the request of a command for the next tick; `own` are the fields of the command with a check."""
    # Some commands do not depend on the state that their teacher saw.
    if hasattr(kind, "seen_tick"):
        own["seen_tick"] = seen
    return TickRequest(boot, command_id, seen, kind(command_id=command_id.hex(), teacher="", **own))


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
    """Query of the robot's description: its task, sensors, actions and limits (`Hello`)."""


@_at("/stop")
class StopRequest(Request):
    """Command of any device that stops the robot; it needs neither a boot id nor a fresh state."""

    command_id: CommandId
    press_id: Number | None = None
    """Press that ends, so that a late copy does not end the next one; None: everything. After a press of `/hold` the
    robot drives on by its RLAs."""


@_at("/situations")
class SituationsRequest(Request):
    """Query of the situations that teachers have named as goals."""


@_at("/save")
class SaveRequest(CommandRequest):
    """Request to copy the knowledge file into a file on the robot, which `/file` then reads."""

    typed = ("save [LABEL]", "a copy of the knowledge, on the robot")
    label: Annotated[str, Text(LONGEST_TEXT)] = ""
    """Part of the copy's name."""


@_at("/export")
class ExportRequest(CommandRequest):
    """Command that writes a file on the robot, which `/file` then reads.

    It holds the RLAs as a table, or all knowledge as a package to give away.
    """

    typed = ("export", "a table of the knowledge, on the robot")
    form: Annotated[str, OneOf((TABLE, PACKAGE))] = TABLE


@_at("/file")
class FileRequest(Request):
    """Query of one part of a file that `/save` or `/export` made since this start of the program."""

    name: Annotated[str, Text(LONGEST_FILE_NAME, least=1)]
    offset: Number
    """Position of the part's first byte in the file."""


@_at("/exam")
class ExamRequest(CommandRequest):
    """Command that examines a copy of the knowledge in simulation, while the robot goes on.

    /exam/standing has the result.
    """


@_at("/exam/standing")
class ExamStatusRequest(Request):
    """Query of the exam under way or the newest one; answered with an `ExamStatus`."""


@_at("/lessons")
class LessonsRequest(Request):
    """Query of the `count` newest lessons; answered with a `LessonLine` each."""

    count: Annotated[int, Int(0, MOST_LESSONS)]


@_at("/health")
class HealthRequest(Request):
    """Query of the health of the robot's program, bus, disk and machine."""


@_at("/why")
class WhyRequest(Request):
    """Query of the facts behind the newest decision, from which the device explains it in words."""


@_at("/world")
class WorldRequest(Request):
    """Query of the simulated world's outline, walls and posts from above; refused by a real robot."""


@_at("/world/move")
class MoveWallRequest(CommandRequest):
    """Command that shifts a wall or a post of the simulated world by `dx_m` and `dy_m`."""

    name: Name
    dx_m: Way
    dy_m: Way


@_at("/world/place")
class PlaceRequest(CommandRequest):
    """Command that sets the simulated robot down at a pose of the world, in m and rad."""

    moves: ClassVar[bool] = True
    x_m: Way
    y_m: Way
    heading_rad: Angle


@_at("/world/start")
class BackToStartRequest(CommandRequest):
    """Command that sets the simulated robot down where its run began."""

    moves: ClassVar[bool] = True


@_at("/simulation")
class SimulationRequest(Request):
    """Query of a simulated robot's world, task and speed, and of the choices for its next run."""


@_at("/simulation/run")
class NextRunRequest(CommandRequest):
    """Command that ends the run of a simulated robot and begins the next one, in which it stands until GO."""

    world: Name | None
    """None: the present world."""
    task: Name | None
    """None: the present task."""
    fresh: Truth
    """Begin with an empty knowledge file; the present one is archived."""


@_at("/simulation/speed")
class SpeedRequest(CommandRequest):
    """Command that lets a simulated robot's time pass faster than real time."""

    times: Annotated[int, Int(1, FASTEST)]
    """Robot seconds in one second."""


@_at("/upload")
class UploadRequest(Request):
    """Part of a file that a device uploads, in order, for `/load`; a repeated part changes nothing."""

    boot: Boot
    upload: UploadId
    """Random id, equal in all parts of one file."""
    offset: Number
    """Position of the part's first byte in the file; 0 begins the file."""
    part: Annotated[bytes, BytesUpTo(UPLOAD_PART_BYTES)]


@_at("/load")
class LoadRequest(CommandRequest):
    """Command that ends the run of a simulated robot, and begins the next one with uploaded knowledge."""

    upload: UploadId
    sha256: Annotated[bytes, Bytes(SHA256_BYTES)]
    """SHA-256 of the whole file."""
