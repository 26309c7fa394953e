"""Requests that are not for the tick: files, uploads, exams, and the simulated world."""

import asyncio
import hashlib
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Coroutine
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from config.errors import UserError
from hal import points
from kurt2rt.channel.protocol.limits import MOST_UPLOAD_BYTES, PART_BYTES
from kurt2rt.channel.protocol.requests import (
    PACKAGE,
    BackToStartRequest,
    ExamRequest,
    ExamStatusRequest,
    ExportRequest,
    FileRequest,
    LoadRequest,
    MoveWallRequest,
    NextRunRequest,
    PlaceRequest,
    Request,
    SaveRequest,
    SimulationRequest,
    SpeedRequest,
    UploadRequest,
    WorldRequest,
)
from kurt2rt.channel.protocol.simulation import EXAM, SIMULATION, WORLD, WorldView
from kurt2rt.channel.server.dependencies import ChannelDependencies, TeacherNow
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, not_simulated, refusal, restarted, unsaved
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.teaching.inbox import SpeedChanged
from kurt2rt.knowledge.files.atomic_write import SavedCopy
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runtime import Runtime
from simbridge.contracts.world_refusal import WorldRefusedError

Part = TypeVar("Part")


class PendingCommands:
    """Replies to commands by command id, so that a repeated command gets the same reply, perhaps later.

    The oldest settled replies are dropped.
    """

    def __init__(self, capacity: int = 1024) -> None:
        self._capacity = capacity
        self._replies: OrderedDict[str, asyncio.Future[Reply]] = OrderedDict()

    def __len__(self) -> int:
        return len(self._replies)

    def get(self, command_id: str) -> asyncio.Future[Reply] | None:
        """Return the reply to an earlier command, perhaps pending; None for a new command."""
        return self._replies.get(command_id)

    def begin(self, command_id: str) -> asyncio.Future[Reply]:
        """Add a new command and return its pending reply."""
        self._drop_oldest()
        reply = self._replies[command_id] = asyncio.get_running_loop().create_future()
        return reply

    def settle(self, command_id: str, reply: Reply) -> None:
        """Resolve a pending reply; commands that did not come over the network are left out."""
        waiting = self._replies.get(command_id)
        if waiting is not None and not waiting.done():
            waiting.set_result(reply)

    def _drop_oldest(self) -> None:
        while len(self._replies) >= self._capacity or points.happens("an answer is forgotten"):
            # A pending command must not be mistaken for a new one when its copy comes.
            oldest = next((command_id for command_id, reply in self._replies.items() if reply.done()), None)
            if oldest is None:
                return
            del self._replies[oldest]


def failure(failed: RefusalCode, crashed: RefusalCode, error: Exception) -> Outcome:
    """Return the refusal that tells a teacher why work failed, such as a copy of the knowledge.

    Args:
        failed: code for an error that the teacher can mend.
        crashed: code for an error of the program, which is shown as repr.
        error: a refusal keeps its own code.
    """
    if isinstance(error, CommandRefusedError):
        return error.outcome
    if isinstance(error, UserError):
        return known_failure(failed, error)
    return Outcome.of(crashed, error=_line(repr(error)))


def known_failure(code: RefusalCode, error: UserError) -> Outcome:
    """Return the outcome of an error that the teacher can mend.

    `cause` is the code of a knowledge error, else empty; `where` its file; `says` its line in the words of its table.
    """
    return Outcome.of(
        code,
        cause=error.code.value if isinstance(error, KnowledgeError) else "",
        where=error.where,
        says=_line(str(error)),
    )


def _line(text: str) -> str:
    return " ".join(text.split())


LAST_ANSWER_S = 0.3
"""Time from the answer to the end of the run: room for three copies of the request, which come each 0.1 s."""

OffTickCommand = (
    SpeedRequest
    | NextRunRequest
    | LoadRequest
    | ExamRequest
    | SaveRequest
    | ExportRequest
    | MoveWallRequest
    | PlaceRequest
    | BackToStartRequest
)


class Upload:
    """File that a device is uploading in parts, kept in memory; a newer upload replaces it."""

    def __init__(self, most_bytes: int = MOST_UPLOAD_BYTES) -> None:
        self._most_bytes = most_bytes
        self._of: tuple[str, bytes] | None = None
        self._content = bytearray()

    def add(self, device: str, upload: bytes, offset: int, part: bytes) -> int:
        """Append a part to a device's upload and return the size so far in bytes; a repeated part changes nothing.

        `upload`: id of the upload. `offset`: position of the part in bytes. Raises CommandRefusedError for a gap, too
        many bytes, or a repeated part that differs.
        """
        if self._of != (device, upload):
            if offset != 0:
                raise CommandRefusedError(RefusalCode.UPLOAD_UNKNOWN)
            self._of, self._content = (device, upload), bytearray()
        if offset > len(self._content):
            raise CommandRefusedError(RefusalCode.UPLOAD_GAP, offset=offset, size=len(self._content))
        if offset + len(part) > self._most_bytes:
            raise CommandRefusedError(RefusalCode.UPLOAD_TOO_LARGE, most_bytes=self._most_bytes)
        if self._content[offset : offset + len(part)] not in (b"", part):
            raise CommandRefusedError(RefusalCode.UPLOAD_DIFFERS, offset=offset)
        self._content[offset : offset + len(part)] = part
        return len(self._content)

    def pop(self, device: str, upload: bytes, sha256: bytes) -> bytes:
        """Return the whole file of a device's upload and drop it; `sha256` is the hash that it must have.

        Raises CommandRefusedError if it is another upload, or not whole.
        """
        if self._of != (device, upload) or hashlib.sha256(self._content).digest() != sha256:
            raise CommandRefusedError(RefusalCode.UPLOAD_INCOMPLETE)
        content = bytes(self._content)
        self._of, self._content = None, bytearray()
        return content


class _RefusedError(Exception):
    """Request that is not carried out, with its reply."""

    def __init__(self, reply: Reply) -> None:
        super().__init__(reply)
        self.reply = reply


class OffTickRequests:
    """Handler of requests that no tick carries out, such as copies and the next run.

    Threads do the slow work.
    """

    def __init__(
        self, runtime: Runtime, parts: ChannelDependencies, pending: PendingCommands, tick: Callable[[], int]
    ) -> None:
        """`tick` returns the tick of the newest state."""
        self._runtime = runtime
        self._parts = parts
        self._pending = pending
        self._tick = tick
        self._upload = Upload()
        self._changing_run = False
        self._under_way: set[asyncio.Task[None]] = set()

    def close(self) -> None:
        """Cancel the copies and the preparation of a next run that are under way."""
        for task in self._under_way:
            task.cancel()

    async def answer(self, device: str, request: Request) -> Reply:
        """Return the reply to a request that is no command; NOT_HERE for a request that is not handled here."""
        try:
            match request:
                case WorldRequest():
                    return self._world()
                case SimulationRequest():
                    return await self._simulation_view()
                case ExamStatusRequest():
                    exam = _simulated(self._parts.exam)
                    return Reply(ReplyStatus.DONE, {"exam": EXAM.plain_of(exam())})
                case UploadRequest():
                    return self._add_part(device, request)
                case FileRequest(name=name, offset=offset):
                    return await self._file_part(name, offset)
            return Reply(ReplyStatus.NOT_HERE)
        except (_RefusedError, CommandRefusedError) as error:
            return self._reply_to(error)

    def begin(self, device: str, command_id: str, request: OffTickCommand) -> Reply | None:
        """Carry out a command, or begin it; return a refusal, or None.

        After None its reply is, or will be, in the pending commands.
        """
        try:
            match request:
                case SpeedRequest(times=times):
                    self._change_speed(device, command_id, times)
                case NextRunRequest() | LoadRequest():
                    self._begin_next_run(device, command_id, request)
                case ExamRequest():
                    self._begin_exam(device, command_id)
                case SaveRequest() | ExportRequest():
                    self._refuse_others(device)
                    self._begin(command_id, self._copy(command_id, self._copying(request)))
                case MoveWallRequest() | PlaceRequest() | BackToStartRequest():
                    reply = self._change_world(device, request)
                    self._pending.begin(command_id).set_result(reply)
        except (_RefusedError, CommandRefusedError) as error:
            return self._reply_to(error)
        return None

    async def _simulation_view(self) -> Reply:
        parts = self._parts
        view = await _simulated(parts.run_control).view()
        if parts.speed is not None:
            view = replace(view, speed=parts.speed.wanted, reached=parts.speed.reached)
        if parts.progress is not None:
            view = replace(view, progress=parts.progress.progress, unit=parts.progress.unit)
        return Reply(ReplyStatus.DONE, {"simulation": SIMULATION.plain_of(view)})

    def _begin_exam(self, device: str, command_id: str) -> None:
        exam = _simulated(self._parts.exam)
        self._refuse_unless_teacher(device)
        if exam().running:
            raise CommandRefusedError(RefusalCode.EXAM_UNDER_WAY)
        self._begin(command_id, self._examine(command_id))

    async def _examine(self, command_id: str) -> None:
        try:
            await self._parts.copies.examine()
        except Exception as error:  # noqa: BLE001 - any failure goes to the teacher, and the robot goes on
            failed = failure(RefusalCode.EXAM_FAILED, RefusalCode.EXAM_CRASHED, error)
            self._pending.settle(command_id, self._refused(failed))
        else:
            self._pending.settle(command_id, done(self._tick(), Outcome(ResultCode.EXAM_BEGUN)))

    def _add_part(self, device: str, request: UploadRequest) -> Reply:
        _simulated(self._parts.run_control)
        if request.boot != self._parts.boot:
            return restarted(self._tick())
        self._refuse_unless_teacher(device)
        return done(self._tick(), size=self._upload.add(device, request.upload, request.offset, request.part))

    def _change_speed(self, device: str, command_id: str, times: int) -> None:
        _simulated(self._parts.run_control)
        speed = _simulated(self._parts.speed)
        self._refuse_unless_teacher(device)
        speed.set(times)
        self._runtime.inbox.put(SpeedChanged(times))
        reply = done(self._tick(), Outcome.of(ResultCode.SPEED_SET, times=times))
        self._pending.begin(command_id).set_result(reply)

    def _begin_next_run(self, device: str, command_id: str, request: NextRunRequest | LoadRequest) -> None:
        control = _simulated(self._parts.run_control)
        self._refuse_unless_teacher(device)
        if self._changing_run:
            raise CommandRefusedError(RefusalCode.NEXT_RUN_UNDER_WAY)
        commands = self._runtime.handler
        teacher = TeacherNow(device, int(commands.phase), commands.clock.session)
        if isinstance(request, LoadRequest):
            prepare = partial(control.load, self._upload.pop(device, request.upload, request.sha256), teacher)
        else:
            prepare = partial(control.prepare, request.world, request.task, request.fresh, teacher)
        self._changing_run = True
        self._begin(command_id, self._change_run(command_id, prepare))

    async def _change_run(self, command_id: str, prepare: Callable[[], Awaitable[Outcome]]) -> None:
        try:
            await self._parts.copies.settle()  # lessons that wait for a failing disk would end with their run
            outcome = await prepare()
        except Exception as error:  # noqa: BLE001 - any failure goes to the teacher, and the robot goes on
            failed = failure(RefusalCode.NEXT_RUN_FAILED, RefusalCode.NEXT_RUN_CRASHED, error)
            self._pending.settle(command_id, self._refused(failed))
            self._changing_run = False
            return
        self._pending.settle(command_id, done(self._tick(), outcome))
        # The answer, and the copies of it that a bad link needs, go out before the channel of this run closes.
        await asyncio.sleep(LAST_ANSWER_S)
        self._runtime.scheduler.end()

    def _refused(self, outcome: Outcome) -> Reply:
        return refusal("refused", outcome, self._tick())

    def _reply_to(self, error: _RefusedError | CommandRefusedError) -> Reply:
        return error.reply if isinstance(error, _RefusedError) else self._refused(error.outcome)

    def _refuse_others(self, device: str) -> None:
        """Refuse a device while another teaches."""
        held = self._runtime.handler.authority.refusal_for(device)
        if held is not None:
            raise _RefusedError(refusal("held", held, self._tick()))

    def _refuse_unless_teacher(self, device: str) -> None:
        """Refuse a device that is not the robot's teacher."""
        if self._runtime.handler.authority.teacher is None:
            raise _RefusedError(refusal("held", Outcome(RefusalCode.NO_TEACHER), self._tick()))
        self._refuse_others(device)

    def _begin(self, command_id: str, work: Coroutine[Any, Any, None]) -> None:
        """Begin a command whose work waits for threads; `close` cancels it."""
        self._pending.begin(command_id)
        task = asyncio.get_running_loop().create_task(work)
        self._under_way.add(task)
        task.add_done_callback(self._under_way.discard)

    def _copying(self, request: SaveRequest | ExportRequest) -> Awaitable[SavedCopy]:
        copies = self._parts.copies
        if isinstance(request, SaveRequest):
            return copies.save(request.label)
        return copies.package() if request.form == PACKAGE else copies.export()

    async def _file_part(self, name: str, offset: int) -> Reply:
        try:
            part = await self._parts.copies.read(name, offset, PART_BYTES)
        except KnowledgeError as error:
            if error.code is KnowledgeCode.UNKNOWN_COPY:
                return self._refused(Outcome.of(RefusalCode.NO_FILE, name=name))
            return self._refused(known_failure(RefusalCode.FILE_UNREADABLE, error))
        return Reply(ReplyStatus.DONE, {"size": part.size_bytes, "part": part.content})

    async def _copy(self, command_id: str, copying: Awaitable[SavedCopy]) -> None:
        try:
            copy = await copying
        except Exception as error:  # noqa: BLE001 - any failure goes to the teacher, and the robot goes on
            failed = failure(RefusalCode.COPY_FAILED, RefusalCode.COPY_CRASHED, error)
            self._pending.settle(command_id, unsaved(failed, self._tick()))
        else:
            copied = Outcome.of(ResultCode.COPIED, name=copy.name, size=copy.size_bytes)
            reply = done(self._tick(), copied, name=copy.name, sha256=copy.sha256, size=copy.size_bytes)
            self._pending.settle(command_id, reply)

    def _change_world(self, device: str, request: MoveWallRequest | PlaceRequest | BackToStartRequest) -> Reply:
        world = _simulated(self._parts.world)
        self._refuse_others(device)
        try:
            if isinstance(request, MoveWallRequest):
                world.move_wall(request.name, request.dx_m, request.dy_m)
                return done(self._tick(), Outcome.of(ResultCode.WALL_MOVED, name=request.name))
            # The teacher who stopped the robot looks at the place where it stands.
            stopped = self._runtime.handler.stops.refusal_since(request.seen)
            if stopped is not None:
                return self._refused(stopped)
            if isinstance(request, BackToStartRequest):
                world.put_robot_back()
            else:
                world.put_robot(request.x_m, request.y_m, request.heading_rad)
            self._runtime.reposition()
        except WorldRefusedError as error:
            return self._refused(Outcome(RefusalCode[error.code.name], error.fields))
        return done(self._tick(), Outcome(ResultCode.ROBOT_PLACED))

    def _world(self) -> Reply:
        view = _simulated(self._parts.world).world()
        told = WorldView(view.version, view.name, view.size_m, view.outline, view.walls, view.posts)
        return Reply(ReplyStatus.DONE, WORLD.plain_of(told))


def _simulated(part: Part | None) -> Part:
    """Return a part that only simulated robots have, or refuse the request."""
    if part is None:
        raise _RefusedError(not_simulated())
    return part
