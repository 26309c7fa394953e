"""Requests that the tick does not carry out: files, uploads, exams, and the simulated world."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from dataclasses import replace
from functools import partial
from typing import Any, Protocol

from hal.simulation import SimulatedWorld
from kurt2rt.channel.protocol.exam_status import EXAM, ExamStatus
from kurt2rt.channel.protocol.requests import (
    PACKAGE,
    PART_BYTES,
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
from kurt2rt.channel.protocol.simulation import SIMULATION
from kurt2rt.channel.server.pending_commands import PendingCommands
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, plain_outcome, refusal, restarted, unsaved
from kurt2rt.channel.server.simulation import ProgressMeter, RunControl, TeacherNow
from kurt2rt.channel.server.upload import Upload
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.teaching.system_events import SpeedChanged
from kurt2rt.knowledge.files.atomic_write import SavedCopy
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.file_part import FilePart
from kurt2rt.platform.simulated_clock import Speed
from kurt2rt.runtime import Runtime

LAST_ANSWER_S = 0.3
"""From the answer to the end of the run: for three copies of the request, which a device sends each 0.1 s."""

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


class Copies(Protocol):
    """Makes copies of the knowledge on the robot, outside the loop."""

    def save(self, label: str) -> Awaitable[SavedCopy]:
        """A copy of the knowledge file. Raises KnowledgeError."""
        ...

    def export(self) -> Awaitable[SavedCopy]:
        """The RLAs as a table. Raises KnowledgeError."""
        ...

    def package(self) -> Awaitable[SavedCopy]:
        """All of the knowledge as one file to give away. Raises KnowledgeError."""
        ...

    def examine(self) -> Awaitable[None]:
        """Begin an exam of a copy of the knowledge. Raises KnowledgeError."""
        ...

    def settle(self) -> Awaitable[None]:
        """Wait until all that was taught is durable. Raises KnowledgeError."""
        ...

    def read(self, name: str, offset: int, most_bytes: int) -> Awaitable[FilePart]:
        """Part of a copy that was made here. Raises KnowledgeError."""
        ...


class OffTickRequests:
    """Handler of the requests that do not go to the next tick; threads do what takes long."""

    def __init__(
        self,
        runtime: Runtime,
        boot: bytes,
        outcomes: PendingCommands,
        tick: Callable[[], int],
        copies: Copies,
        ground: SimulatedWorld | None,
        exam: Callable[[], ExamStatus] | None,
        simulation: RunControl | None,
        speed: Speed | None,
        measure: ProgressMeter | None,
    ) -> None:
        """`tick`: that of the newest picture. The other arguments are those of `Reception`."""
        self._runtime = runtime
        self._boot = boot
        self._outcomes = outcomes
        self._tick = tick
        self._copies = copies
        self._ground = ground
        self._exam = exam
        self._simulation = simulation
        self._speed = speed
        self._measure = measure
        self._upload = Upload()
        self._changing = False
        self._under_way: set[asyncio.Task[None]] = set()

    def close(self) -> None:
        """Give up the copies, and the preparation of a next run, that are under way."""
        for task in self._under_way:
            task.cancel()

    async def answer(self, device: str, request: Request) -> Reply:
        """Return the reply to a request that is no command; NOT_HERE for a request that is not handled here."""
        match request:
            case WorldRequest():
                return self._world()
            case SimulationRequest():
                return await self._simulation_view()
            case ExamStatusRequest():
                if self._exam is None:
                    return _not_simulated()
                return Reply(ReplyStatus.DONE, {"exam": EXAM.plain_of(self._exam())})
            case UploadRequest():
                return self._add_part(device, request)
            case FileRequest(name=name, offset=offset):
                return await self._part(name, offset)
        return Reply(ReplyStatus.NOT_HERE)

    def begin(self, device: str, command_id: str, request: OffTickCommand) -> Reply | None:
        """Carry out a command; return a refusal, or None where its outcome has begun."""
        match request:
            case SpeedRequest(times=times):
                refused = self._change_speed(device, times)
                if refused is None:
                    self._outcomes.begin(command_id).set_result(
                        done(self._tick(), Outcome.of(ResultCode.SPEED_SET, times=times))
                    )
                return refused
            case NextRunRequest() | LoadRequest():
                return self._begin_next_run(device, command_id, request)
            case ExamRequest():
                return self._begin_exam(device, command_id)
            case SaveRequest() | ExportRequest():
                held = self._runtime.handler.authority.refusal_for(device)
                if held is not None:
                    return refusal("held", held, self._tick())
                self._outcomes.begin(command_id)
                self._do_outside(self._copy(command_id, self._copying(request)))
                return None
            case MoveWallRequest() | PlaceRequest() | BackToStartRequest():
                reply = self._change_world(device, request)
                self._outcomes.begin(command_id).set_result(reply)
                return None

    async def _simulation_view(self) -> Reply:
        if self._simulation is None:
            return _not_simulated()
        view = await self._simulation.view()
        if self._speed is not None:
            view = replace(view, speed=self._speed.wanted, reached=self._speed.reached)
        if self._measure is not None:
            view = replace(view, progress=self._measure.progress, unit=self._measure.unit)
        return Reply(ReplyStatus.DONE, {"simulation": SIMULATION.plain_of(view)})

    def _begin_exam(self, device: str, command_id: str) -> Reply | None:
        if self._exam is None:
            return _not_simulated()
        refused = self._not_in_charge(device)
        if refused is not None:
            return refused
        if self._exam().running:
            return refusal("refused", Outcome(RefusalCode.EXAM_UNDER_WAY), self._tick())
        self._outcomes.begin(command_id)
        self._do_outside(self._examine(command_id))
        return None

    async def _examine(self, command_id: str) -> None:
        try:
            await self._copies.examine()
        except Exception as error:  # noqa: BLE001 - whatever it is, the teacher is told, and the robot goes on
            text = str(error) if isinstance(error, KnowledgeError) else f"the exam failed: {error!r}"
            failed = Outcome.of(RefusalCode.EXAM_FAILED, says=text)
            self._outcomes.settle(command_id, refusal("refused", failed, self._tick()))
        else:
            self._outcomes.settle(command_id, done(self._tick(), Outcome(ResultCode.EXAM_BEGUN)))

    def _add_part(self, device: str, request: UploadRequest) -> Reply:
        if self._simulation is None:
            return _not_simulated()
        if request.boot != self._boot:
            return restarted(self._tick())
        refused = self._not_in_charge(device)
        if refused is not None:
            return refused
        try:
            size = self._upload.add(device, request.upload, request.offset, request.part)
        except CommandRefusedError as error:
            return refusal("refused", error.outcome, self._tick())
        return done(self._tick(), size=size)

    def _change_speed(self, device: str, times: int) -> Reply | None:
        """A refusal; None where robot time passes so from the next tick on."""
        if self._simulation is None:
            return _not_simulated()
        if self._speed is None:
            return refusal("refused", Outcome(RefusalCode.OWN_TIME), self._tick())
        refused = self._not_in_charge(device)
        if refused is None:
            self._speed.set(times)
            self._runtime.inbox.put(SpeedChanged(times))
        return refused

    def _begin_next_run(self, device: str, command_id: str, request: NextRunRequest | LoadRequest) -> Reply | None:
        if self._simulation is None:
            return _not_simulated()
        refused = self._not_in_charge(device)
        if refused is not None:
            return refused
        if self._changing:
            return refusal("refused", Outcome(RefusalCode.NEXT_RUN_UNDER_WAY), self._tick())
        school = self._runtime.handler
        teacher = TeacherNow(device, int(school.phase), school.session)
        if isinstance(request, LoadRequest):
            try:
                content = self._upload.take(device, request.upload, request.sha256)
            except CommandRefusedError as error:
                return refusal("refused", error.outcome, self._tick())
            prepare = partial(self._simulation.load, content, teacher)
        else:
            prepare = partial(self._simulation.prepare, request.world, request.task, request.fresh, teacher)
        self._changing = True
        self._outcomes.begin(command_id)
        self._do_outside(self._change_run(command_id, prepare))
        return None

    async def _change_run(self, command_id: str, prepare: Callable[[], Awaitable[str]]) -> None:
        try:
            await self._copies.settle()  # lessons that wait for a failing disk end with their run
            text = await prepare()
        except Exception as error:  # noqa: BLE001 - whatever it is, the teacher is told, and the robot goes on
            told = isinstance(error, ValueError | KnowledgeError)
            text = str(error) if told else f"the next run cannot begin: {error!r}"
            failed = Outcome.of(RefusalCode.NEXT_RUN_FAILED, says=" ".join(text.split()))
            self._outcomes.settle(command_id, refusal("refused", failed, self._tick()))
            self._changing = False
            return
        self._outcomes.settle(command_id, done(self._tick(), Outcome.of(ResultCode.NEXT_RUN, says=text)))
        # The answer, and copies of it that a bad link needs, go out before the channel of this run closes.
        await asyncio.sleep(LAST_ANSWER_S)
        self._runtime.scheduler.end()

    def _not_in_charge(self, device: str) -> Reply | None:
        """A refusal for a device that is not the robot's teacher."""
        authority = self._runtime.handler.authority
        held = authority.refusal_for(device)
        if held is None and authority.teacher is None:
            held = Outcome(RefusalCode.NO_TEACHER)
        return None if held is None else refusal("held", held, self._tick())

    def _do_outside(self, work: Coroutine[Any, Any, None]) -> None:
        """Do what waits for threads, without the tick; given up when the channel closes."""
        task = asyncio.get_running_loop().create_task(work)
        self._under_way.add(task)
        task.add_done_callback(self._under_way.discard)

    def _copying(self, request: SaveRequest | ExportRequest) -> Awaitable[SavedCopy]:
        if isinstance(request, SaveRequest):
            return self._copies.save(request.label)
        return self._copies.package() if request.form == PACKAGE else self._copies.export()

    async def _part(self, name: str, offset: int) -> Reply:
        try:
            part = await self._copies.read(name, offset, PART_BYTES)
        except KnowledgeError as error:
            return refusal("refused", Outcome.of(RefusalCode.NO_FILE, says=str(error)), self._tick())
        return Reply(ReplyStatus.DONE, {"size": part.size_bytes, "part": part.content})

    async def _copy(self, command_id: str, copying: Awaitable[SavedCopy]) -> None:
        try:
            copy = await copying
        except Exception as error:  # noqa: BLE001 - whatever it is, the teacher is told, and the robot goes on
            text = str(error) if isinstance(error, KnowledgeError) else f"the copy failed: {error!r}"
            self._outcomes.settle(command_id, unsaved(Outcome.of(RefusalCode.COPY_FAILED, says=text), self._tick()))
        else:
            copied = Outcome.of(ResultCode.COPIED, name=copy.name, size=copy.size_bytes)
            reply = done(self._tick(), copied, name=copy.name, sha256=copy.sha256, size=copy.size_bytes)
            self._outcomes.settle(command_id, reply)

    def _change_world(self, device: str, request: MoveWallRequest | PlaceRequest | BackToStartRequest) -> Reply:
        if self._ground is None:
            return _not_simulated()
        held = self._runtime.handler.authority.refusal_for(device)
        if held is not None:
            return refusal("held", held, self._tick())
        try:
            if isinstance(request, MoveWallRequest):
                self._ground.move_wall(request.name, request.dx_m, request.dy_m)
                return done(self._tick(), Outcome.of(ResultCode.WALL_MOVED, name=request.name))
            # The teacher who stopped it looks at it where it stands.
            stopped = self._runtime.handler.refusal_if_stopped_since(request.seen)
            if stopped is not None:
                return refusal("refused", stopped, self._tick())
            if isinstance(request, BackToStartRequest):
                self._ground.put_robot_back()
            else:
                self._ground.put_robot(request.x_m, request.y_m, request.heading_rad)
            self._runtime.reposition()
        except ValueError as error:
            return refusal("refused", Outcome.of(RefusalCode.WORLD_REFUSES, says=str(error)), self._tick())
        return done(self._tick(), Outcome(ResultCode.ROBOT_PLACED))

    def _world(self) -> Reply:
        if self._ground is None:
            return _not_simulated()
        view = self._ground.world()
        body = {
            "version": view.version,
            "name": view.name,
            "size": list(view.size_m),
            "outline": [list(corner) for corner in view.outline],
            "walls": [[wall.name, [list(corner) for corner in wall.corners]] for wall in view.walls],
            "round": [list(post) for post in view.posts],
        }
        return Reply(ReplyStatus.DONE, body)


def _not_simulated() -> Reply:
    return Reply(ReplyStatus.NOT_HERE, {"why": "refused", **plain_outcome(Outcome(RefusalCode.NOT_SIMULATED))})
