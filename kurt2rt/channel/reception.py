"""The rules by which the robot takes what its teachers send. Who sent it is certain here; when and why is not."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine, Mapping
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

from kurt2rt.channel.allowance import Allowance
from kurt2rt.channel.command_of import command_of
from kurt2rt.channel.exam_standing import EXAM, ExamStanding
from kurt2rt.channel.ground import Ground
from kurt2rt.channel.outcomes import Outcomes
from kurt2rt.channel.reply import Reply, Verdict, done, refusal, unsaved
from kurt2rt.channel.requests import (
    MOST_SITUATIONS,
    PACKAGE,
    PART_BYTES,
    BackToStartRequest,
    BehaviourRequest,
    CommandRequest,
    DriveRequest,
    ExamRequest,
    ExamStandingRequest,
    ExportRequest,
    FileRequest,
    HealthRequest,
    HelloRequest,
    LessonsRequest,
    LoadRequest,
    MoveWallRequest,
    NextRunRequest,
    PlaceRequest,
    PursueRequest,
    Request,
    ResumeRequest,
    SaveRequest,
    SeekLikeRequest,
    SeekRequest,
    SeekRlaRequest,
    SimulationRequest,
    SituationsRequest,
    SpeedRequest,
    StopRequest,
    StreamRequest,
    TakeRequest,
    UploadRequest,
    WhyRequest,
    WorldRequest,
)
from kurt2rt.channel.simulation import SIMULATION, Measure, Simulation, TeacherNow
from kurt2rt.channel.upload import Upload
from kurt2rt.health.plain import plain_of
from kurt2rt.health.report import HealthReport
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.safe import FilePart
from kurt2rt.knowledge.saved_copy import SavedCopy
from kurt2rt.rla.rla import MID
from kurt2rt.runtime import Runtime
from kurt2rt.teaching.commands import (
    Command,
    Drive,
    Stop,
    Watch,
)
from kurt2rt.teaching.happenings import SpeedChanged
from kurt2rt.teaching.inbox import InboxFullError
from kurt2rt.timing.simulated_clock import Speed

STREAM_TICKS = 40
"""A message of a stream on an older picture is refused: it was held back on its way."""
MOVING_TICKS = 100
COMMAND_TICKS = 300
_SEEKING = (SeekRequest, SeekRlaRequest, SeekLikeRequest)
_MOVING = (BehaviourRequest, PursueRequest, ResumeRequest, TakeRequest, *_SEEKING)
MOST_WHYS, WHY_EVERY_TICKS = 5, 10
"""An answer takes about a millisecond of the loop; a device says it again every 0.1 s until it is answered."""
LAST_ANSWER_S = 0.3
"""From the answer to the end of the run: for three copies of the request, which a device sends each 0.1 s."""
LONGEST_WAIT_S = 3.0
"""Then a lesson that is not durable yet is answered as unsaved."""


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

    def read(self, name: str, offset: int, most_bytes: int) -> Awaitable[FilePart]:
        """Part of a copy that was made here. Raises KnowledgeError."""
        ...


class Sender(NamedTuple):
    """Whose message it is, for certain."""

    device: str
    pairing: bytes
    """Of the device; another one after it was renewed."""
    number: int
    """Grows with each message of a pairing."""


class Reception:
    """Takes requests in the robot's own loop, between two ticks."""

    def __init__(
        self,
        runtime: Runtime,
        boot: bytes,
        hello: Mapping[str, Any],
        stamp_of: Callable[[str], str],
        copies: Copies,
        ground: Ground | None,
        *,
        longest_wait_s: float = LONGEST_WAIT_S,
        health: Callable[[], HealthReport | None] = lambda: None,
        why: Callable[[], dict[str, Any] | None] = lambda: None,
        exam: Callable[[], ExamStanding] | None = None,
        simulation: Simulation | None = None,
        speed: Speed | None = None,
        measure: Measure | None = None,
    ) -> None:
        """`boot`: random bytes of this start. `stamp_of`: when the lesson of a command became durable, or nothing.

        `health`: the newest report; None before the first. `why`: what the newest decision rested on, as plain values.
        `exam`: how the exam stands; None where the robot is not examined. `simulation`: None where the simulator is not
        in this program. `speed`: None where robot time is real time.
        `measure`: None where nothing is measured.
        """
        self._runtime = runtime
        self._boot = boot
        self._hello = hello
        self._stamp_of = stamp_of
        self._copies = copies
        self._ground = ground
        self._longest_wait_s = longest_wait_s
        self._health = health
        self._why = why
        self._exam = exam
        self._simulation = simulation
        self._speed = speed
        self._measure = measure
        self._upload = Upload()
        self._changing = False
        self._whys = Allowance(MOST_WHYS, WHY_EVERY_TICKS)
        self._outcomes = Outcomes()
        self._newest: dict[str, Sender] = {}
        self._under_way: set[asyncio.Task[None]] = set()
        self.tick = 0
        """Of the newest picture."""

    def close(self) -> None:
        """Give up the copies that are being made."""
        for task in self._under_way:
            task.cancel()

    def settle(self, command_id: str, reply: Reply) -> None:
        """What became of a command that had come in."""
        self._outcomes.settle(command_id, reply)

    async def answer(self, sender: Sender, request: Request) -> Reply:
        """The reply to a request."""
        device = sender.device
        match request:
            case StreamRequest():
                return self._stream(sender, request)
            case StopRequest(command_id=identity, hold=hold):
                return await self._stop(sender, f"{device}-{identity.hex()}", hold)
            case CommandRequest():
                return await self._command(device, request)
            case HelloRequest():
                return Reply(Verdict.DONE, {**self._hello, "tick": self.tick})
            case LessonsRequest(count=count):
                return Reply(Verdict.DONE, {"lessons": self._lessons(count)})
            case SituationsRequest():
                return Reply(Verdict.DONE, {"situations": self._situations()})
            case HealthRequest():
                health = self._health()
                return Reply(Verdict.DONE, {"health": None if health is None else plain_of(health)})
            case WhyRequest():
                if not self._whys.take(sender.device, self.tick):
                    return refusal("refused", "asked too often; ten times a second is enough", self.tick)
                return Reply(Verdict.DONE, {"why": self._why()})
            case WorldRequest():
                return self._world()
            case SimulationRequest():
                if self._simulation is None:
                    return _not_simulated()
                view = await self._simulation.view()
                if self._speed is not None:
                    view = replace(view, speed=self._speed.wanted, reached=self._speed.reached)
                if self._measure is not None:
                    view = replace(view, progress=self._measure.progress, unit=self._measure.unit)
                return Reply(Verdict.DONE, {"simulation": SIMULATION.plain_of(view)})
            case ExamStandingRequest():
                if self._exam is None:
                    return _not_simulated()
                return Reply(Verdict.DONE, {"exam": EXAM.plain_of(self._exam())})
            case UploadRequest():
                return self._add_part(sender.device, request)
            case FileRequest(name=name, offset=offset):
                return await self._part(name, offset)
        return Reply(Verdict.NOT_HERE)

    def _stream(self, sender: Sender, request: StreamRequest) -> Reply:
        tick, school, device = self.tick, self._runtime.school, sender.device
        stale = self._stale(request.boot, request.seen, STREAM_TICKS)
        if stale is not None:
            return stale
        if not self._is_newest(sender):
            return refusal("old", "a newer message came before this one", tick)
        command: Watch | Drive = Watch(device, request.seen)
        if isinstance(request, DriveRequest):
            command = Drive(device, request.seen, request.hold, request.left_m_s, request.right_m_s)
        held = school.authority.held_by_another(device)
        if held is not None:
            return refusal("held", held, tick)
        ended = school.why_not_by_hand(command)
        if ended is not None:
            return refusal("stopped", ended, tick)
        return Reply(Verdict.DONE, {"t": tick}) if self._hand_in(command) else self._too_many()

    async def _stop(self, sender: Sender, command_id: str, hold: int | None) -> Reply:
        # What of a press was sent before the stop and comes after it is over, too.
        self._is_newest(sender)
        # Each copy stops again, whatever came of the one before: the robot may have been told to drive meanwhile.
        if not self._hand_in(Stop(command_id, sender.device, hold)):
            return self._too_many()
        # Shielded: the end of one copy's request must not end what the next copy waits for.
        return await asyncio.shield(self._outcomes.get(command_id) or self._outcomes.begin(command_id))

    async def _command(self, device: str, request: CommandRequest) -> Reply:
        command_id = f"{device}-{request.command_id.hex()}"
        waiting = self._outcomes.get(command_id)
        if waiting is None:
            if self._runtime.school.has_taken(command_id):  # before this start of the program, or long ago
                return done(self.tick, "had been taken already; counted once")
            longest = MOVING_TICKS if isinstance(request, _MOVING) else COMMAND_TICKS
            stale = self._stale(request.boot, request.seen, longest)
            if stale is not None:
                return stale
            reply = self._begin(device, command_id, request)
            if reply is not None:
                return reply
            waiting = self._outcomes.get(command_id)
            assert waiting is not None
        try:
            return await asyncio.wait_for(asyncio.shield(waiting), self._longest_wait_s)
        except TimeoutError:
            return unsaved("not saved yet; it may still count: look at the lessons", self.tick)

    def _begin(self, device: str, command_id: str, request: CommandRequest) -> Reply | None:
        """Hand a command to the next tick, or carry out one that is not the tick's; a reply where that ends it."""
        match request:
            case SpeedRequest(times=times):
                refused = self._change_speed(device, times)
                if refused is None:
                    self._outcomes.begin(command_id).set_result(done(self.tick, f"speed {times}"))
                return refused
            case NextRunRequest() | LoadRequest():
                return self._begin_next_run(device, command_id, request)
            case ExamRequest():
                return self._begin_exam(device, command_id)
            case SaveRequest() | ExportRequest():
                held = self._runtime.school.authority.held_by_another(device)
                if held is not None:
                    return refusal("held", held, self.tick)
                self._outcomes.begin(command_id)
                self._do_outside(self._copy(command_id, self._copying(request)))
                return None
            case MoveWallRequest() | PlaceRequest() | BackToStartRequest():
                reply = self._change_world(device, request)
                self._outcomes.begin(command_id).set_result(reply)
                return None
        held = self._runtime.school.authority.held_by_another(device)
        if held is not None and not isinstance(request, TakeRequest):
            return refusal("held", held, self.tick)
        self._outcomes.begin(command_id)
        if not self._hand_in(command_of(device, command_id, request)):
            reply = self._too_many()
            self._outcomes.settle(command_id, reply)
        return None

    def _begin_exam(self, device: str, command_id: str) -> Reply | None:
        if self._exam is None:
            return _not_simulated()
        refused = self._not_in_charge(device)
        if refused is not None:
            return refused
        if self._exam().running:
            return refusal("refused", "an exam is under way; wait for its end", self.tick)
        self._outcomes.begin(command_id)
        self._do_outside(self._examine(command_id))
        return None

    async def _examine(self, command_id: str) -> None:
        try:
            await self._copies.examine()
        except Exception as error:  # noqa: BLE001 - whatever it is, the teacher is told, and the robot goes on
            text = str(error) if isinstance(error, KnowledgeError) else f"the exam failed: {error!r}"
            self._outcomes.settle(command_id, refusal("refused", text, self.tick))
        else:
            self._outcomes.settle(command_id, done(self.tick, "the exam has begun; the robot goes on meanwhile"))

    def _add_part(self, device: str, request: UploadRequest) -> Reply:
        if self._simulation is None:
            return _not_simulated()
        if request.boot != self._boot:
            return self._started_anew()
        refused = self._not_in_charge(device)
        if refused is not None:
            return refused
        try:
            size = self._upload.add(device, request.upload, request.offset, request.part)
        except ValueError as error:
            return refusal("refused", str(error), self.tick)
        return done(self.tick, size=size)

    def _change_speed(self, device: str, times: int) -> Reply | None:
        """A refusal; None where robot time passes so from the next tick on."""
        if self._simulation is None:
            return _not_simulated()
        if self._speed is None:
            return refusal(
                "refused", "a simulated wire has a time of its own; start kurt2rt run without --wire", self.tick
            )
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
            return refusal("refused", "the next run is being prepared; wait for it", self.tick)
        school = self._runtime.school
        teacher = TeacherNow(device, int(school.phase), school.session)
        if isinstance(request, LoadRequest):
            try:
                content = self._upload.take(device, request.upload, request.sha256)
            except ValueError as error:
                return refusal("refused", str(error), self.tick)
            preparing = self._simulation.load(content, teacher)
        else:
            preparing = self._simulation.prepare(request.world, request.task, request.fresh, teacher)
        self._changing = True
        self._outcomes.begin(command_id)
        self._do_outside(self._change_run(command_id, preparing))
        return None

    async def _change_run(self, command_id: str, preparing: Awaitable[str]) -> None:
        try:
            text = await preparing
        except Exception as error:  # noqa: BLE001 - whatever it is, the teacher is told, and the robot goes on
            text = str(error) if isinstance(error, ValueError) else f"the next run cannot begin: {error!r}"
            self._outcomes.settle(command_id, refusal("refused", " ".join(text.split()), self.tick))
            self._changing = False
            return
        self._outcomes.settle(command_id, done(self.tick, text))
        # The answer, and copies of it that a bad link needs, go out before the channel of this run closes.
        await asyncio.sleep(LAST_ANSWER_S)
        self._runtime.scheduler.end()

    def _not_in_charge(self, device: str) -> Reply | None:
        """A refusal for a device that is not the robot's teacher."""
        authority = self._runtime.school.authority
        held = authority.held_by_another(device)
        if held is None and authority.teacher is None:
            held = "nobody teaches the robot; take it first"
        return None if held is None else refusal("held", held, self.tick)

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
            return refusal("refused", str(error), self.tick)
        return Reply(Verdict.DONE, {"size": part.size_bytes, "part": part.content})

    async def _copy(self, command_id: str, copying: Awaitable[SavedCopy]) -> None:
        try:
            copy = await copying
        except Exception as error:  # noqa: BLE001 - whatever it is, the teacher is told, and the robot goes on
            text = str(error) if isinstance(error, KnowledgeError) else f"the copy failed: {error!r}"
            self._outcomes.settle(command_id, unsaved(text, self.tick))
        else:
            text = f"{copy.name}, {copy.size_bytes} bytes"
            reply = done(self.tick, text, name=copy.name, sha256=copy.sha256, size=copy.size_bytes)
            self._outcomes.settle(command_id, reply)

    def _change_world(self, device: str, request: MoveWallRequest | PlaceRequest | BackToStartRequest) -> Reply:
        if self._ground is None:
            return _not_simulated()
        held = self._runtime.school.authority.held_by_another(device)
        if held is not None:
            return refusal("held", held, self.tick)
        try:
            if isinstance(request, MoveWallRequest):
                self._ground.move_wall(request.name, request.dx_m, request.dy_m)
                return done(self.tick, f"{request.name} moved")
            # Whoever stopped it looks at it where it stands.
            stopped = self._runtime.school.stopped_since(request.seen)
            if stopped is not None:
                return refusal("refused", stopped, self.tick)
            if isinstance(request, BackToStartRequest):
                self._ground.put_robot_back()
            else:
                self._ground.put_robot(request.x_m, request.y_m, request.heading_rad)
            self._runtime.set_down()
        except ValueError as error:
            return refusal("refused", str(error), self.tick)
        return done(self.tick, "the robot stands elsewhere")

    def _is_newest(self, sender: Sender) -> bool:
        """Whether nothing newer came from this device; notes it."""
        newest = self._newest.get(sender.device)
        if newest is not None and newest.pairing == sender.pairing and sender.number <= newest.number:
            return False
        self._newest[sender.device] = sender
        return True

    def _stale(self, boot: bytes, seen: int, longest: int) -> Reply | None:
        if boot != self._boot:
            return self._started_anew()
        # So long in real time, which is the teacher's, at any speed of a simulation.
        if not 0 <= self.tick - seen <= longest * self._runtime.school.authority.speed:
            return refusal("stale", "given on an old picture; look at the robot, then say it again", self.tick)
        return None

    def _started_anew(self) -> Reply:
        return refusal("boot", "the robot program was started anew; look at the robot, then say it again", self.tick)

    def _hand_in(self, command: Command) -> bool:
        try:
            self._runtime.inbox.put(command)
        except InboxFullError:
            return False
        return True

    def _too_many(self) -> Reply:
        return refusal("refused", "too many commands wait; say it again", self.tick)

    def _lessons(self, count: int) -> list[list[object]]:
        rows: list[list[object]] = []
        if count:
            for record in reversed(self._runtime.level.system.lessons[-count:]):
                origin = record.event.origin
                stamp = self._stamp_of(origin.command_id)
                rows.append(
                    [
                        origin.command_id,
                        record.text,
                        origin.teacher,
                        int(origin.phase),
                        origin.tick,
                        stamp,
                        record.undone,
                    ]
                )
        return rows

    def _situations(self) -> list[str]:
        return sorted(self._runtime.level.system.named_at(MID))[:MOST_SITUATIONS]

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
        return Reply(Verdict.DONE, body)


def _not_simulated() -> Reply:
    return Reply(Verdict.NOT_HERE, {"why": "refused", "text": "this robot is not simulated"})
