"""The robot's mind behind its request handler, on ticks that the test makes; no socket, no keys, no clock."""

import asyncio
from typing import Any, cast

from hal.guard_reason import GuardReason
from hal.robot import GuardResult, SensorReadings
from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.codec import decode_state, encode_state
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.limits import FASTEST
from kurt2rt.channel.protocol.requests import CommandRequest, Request, StopRequest, StreamRequest, tick_request
from kurt2rt.channel.protocol.simulation import NO_EXAM, SimulationView, TaskName
from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.server.channel import Channel
from kurt2rt.channel.server.dependencies import ChannelDependencies, JournalStatus, TeacherNow
from kurt2rt.channel.server.reply import Reply
from kurt2rt.channel.server.request_handler import LONGEST_WAIT_S, Sender
from kurt2rt.channel.server.resources import Keys
from kurt2rt.core.event_store import EventStore, InMemoryEventStore
from kurt2rt.core.message_fields import checks_of
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, outcome_in
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Drive, HoldAction, Single, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.files.atomic_write import SavedCopy
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.platform.file_part import FilePart
from kurt2rt.platform.simulated_clock import HeldWorld, SimulatedClock
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime
from simbridge.contracts.simulation import SimulatedWorld
from tests.core.test_tick import CorridorRobot

ROBOT = load_robot()
TASK = load_task("wall_following")
BOOT = b"boot"
STAMP = "2004-04-26T10:00:00.000+00:00"


class WideRobot(CorridorRobot):
    """The same count on all sensors that the shipped robot has."""

    def __init__(self) -> None:
        super().__init__()
        self.bumpers = 0
        self.ticks = (0, 0)
        """Encoder ticks of each cycle, left and right."""
        self.refuses: tuple[GuardReason, ...] = ()

    def sense(self, now_s: float) -> SensorReadings:
        counts = (self.counts,) * len(ROBOT.infrared.sensors)
        return SensorReadings(now_s, counts, self.infrared_age_s, *self.ticks, 0.0, self.bumpers, 0.0)

    def drive(self, wanted: Any, decided_at_s: float, now_s: float) -> GuardResult:
        grant = super().drive(wanted, decided_at_s, now_s)
        return grant._replace(reasons=(*grant.reasons, *self.refuses))


class Shelf:
    """Copies of the knowledge that are made when the test says so (kurt2rt.channel.server.dependencies.Copies)."""

    def __init__(self) -> None:
        self.labels: list[str | None] = []
        self.examined = 0
        self.files: dict[str, bytes] = {}
        self.may_finish = asyncio.Event()
        self.may_finish.set()
        self.problem = ""

    async def save(self, label: str) -> SavedCopy:
        return await self._copy(label, "lessons.knowledge")

    async def export(self) -> SavedCopy:
        return await self._copy(None, "lessons.csv")

    async def package(self) -> SavedCopy:
        return await self._copy(None, "lessons.zip")

    async def examine(self) -> None:
        await self.settle()
        self.examined += 1

    async def settle(self) -> None:
        await self.may_finish.wait()
        if self.problem:
            raise KnowledgeError(KnowledgeCode.NOT_DURABLE, reason=self.problem)

    async def read(self, name: str, offset: int, most_bytes: int) -> FilePart:
        if name not in self.files:
            raise KnowledgeError(KnowledgeCode.UNKNOWN_COPY, where=name)
        content = self.files[name]
        return FilePart(len(content), content[offset : offset + most_bytes])

    async def _copy(self, label: str | None, name: str) -> SavedCopy:
        self.labels.append(label)
        await self.settle()
        return SavedCopy(name, "ab" * 32, 4096)


class Runs:
    """Runs of a simulated robot that are only noted (kurt2rt.channel.server.dependencies.RunControl)."""

    def __init__(self) -> None:
        self.prepared: list[tuple[object, ...]] = []

    async def view(self) -> SimulationView:
        return SimulationView("a", "wall_following", ("a", "b"), (TaskName("eight", "Teach it to drive an eight"),))

    async def prepare(self, world: str | None, task: str | None, fresh: bool, teacher: TeacherNow) -> Outcome:
        if world == "nowhere":
            raise CommandRefusedError(RefusalCode.NO_WORLD, world=world, known=("a", "b"))
        if world == "broken":
            raise RuntimeError("no such thing")
        self.prepared.append((world, task, fresh, teacher))
        return Outcome.of(ResultCode.NEXT_RUN, world=world or "a", task=task or "wall_following")

    async def load(self, content: bytes, teacher: TeacherNow) -> Outcome:
        self.prepared.append((content, teacher))
        return Outcome.of(ResultCode.KNOWLEDGE_LOADED, lessons=1)


class ChannelFixture:
    """One robot that needs a teacher, and everything of the channel behind the keys."""

    def __init__(
        self,
        *,
        ground: SimulatedWorld | None = None,
        keys: Keys | None = None,
        keeper: EventStore | None = None,
        longest_wait_s: float = LONGEST_WAIT_S,
        behaviours: tuple[str, ...] = ("",),
        mid: str | None = None,
    ) -> None:
        """`keeper` takes the lessons in place of the notebook; `behaviours` is what the task teaches, `mid` by name."""
        self.robot = WideRobot()
        self.notebook = InMemoryEventStore()
        self.shelf = Shelf()
        self.stamps: dict[str, str] = {}
        self.bus_trouble = ""
        self.exam = NO_EXAM
        self.simulation = Runs()
        self.speed = SimulatedClock(LockstepClock(lambda: None), cast(HeldWorld, None), FASTEST)
        self.health: HealthReport | None = None
        clock = LockstepClock(lambda: None)
        task = TASK.model_copy(update={"behaviours": behaviours, "mid": mid})
        self.runtime: Runtime = build_runtime(
            self.robot, ROBOT, task, (), keeper or self.notebook, clock, RuntimeOptions(attended=True)
        )
        self.parts = ChannelDependencies(
            JournalStatus(
                lambda: self.unwritten,
                lambda: self.notebook.saving_error,
                lambda command_id: self.stamps.get(command_id, ""),
            ),
            self.shelf,
            lambda: self.bus_trouble,
            ground,
            boot=BOOT,
            health=lambda: self.health,
            exam=None if ground is None else lambda: self.exam,
            run_control=None if ground is None else self.simulation,
            speed=None if ground is None else self.speed,
        )
        # Without a socket: nothing here is sent, and the keys are those of the tests of the site.
        self.channel = Channel(self.runtime, cast(Keys, keys), self.parts, longest_wait_s=longest_wait_s)
        self.handler, self.site = self.channel.handler, self.channel.site
        self.record: TickRecord
        self.written = 0
        self._number = 0
        self._ids = 0
        self._tick = 1000  # long after its start, so that pictures of any age were made
        self.run()

    @property
    def unwritten(self) -> int:
        return len(self.notebook.events) - self.written

    @property
    def picture(self) -> State:
        """Return the state of the newest tick, checked by a round trip."""
        told = self.channel._states.build(self.record)
        assert decode_state(encode_state(told)) == told
        return told

    @property
    def tick(self) -> int:
        """Tick of the newest state."""
        return self.handler.tick

    def run(self, ticks: int = 1, counts: int | None = None) -> TickRecord:
        """So many ticks, in which the sensors show `counts`; what they teach stays unwritten."""
        if counts is not None:
            self.robot.counts = counts
        for _ in range(ticks):
            self._tick += 1
            self.runtime.timer.begin(0.0)
            self.record = self.runtime.tick.run(self._tick, self._tick * 0.01)
            self.channel.after_tick(self.record)
            self.runtime.timer.end()
        return self.record

    def write(self, error: str | None = None) -> None:
        """Write all waiting lessons to the disk, or fail them with `error`."""
        for event in self.notebook.events[self.written :]:
            self.written += 1
            command_id = event.origin.command_id
            if error is None:
                self.stamps[command_id] = STAMP
                self.channel.on_acknowledged(Acknowledgement(command_id, self.written, None, STAMP))
            else:
                self.channel.on_acknowledged(Acknowledgement(command_id, None, error, ""))

    def new_id(self) -> bytes:
        self._ids += 1
        return self._ids.to_bytes(8, "big")

    async def send(
        self, request: Request, device: str = "ann", number: int | None = None, pairing: bytes = b"first"
    ) -> "asyncio.Task[Reply]":
        """Send a request and return its task; it is the newest message of its device unless `number` is given.

        What is waiting must be awaited with `reply_of`, after the tick that answers it.
        """
        self._number += 1
        sender = Sender(device, pairing, self._number if number is None else number)
        answer = self.handler.answer(sender, request)
        task = asyncio.get_running_loop().create_task(answer)
        await turns()
        return task

    async def ask(self, request: Request, device: str = "ann", *, write: bool = True) -> Reply:
        """Send a request, run the tick that handles it, write its lessons, and return the reply."""
        task = await self.send(request, device)
        if not task.done():
            self.run()
            if write:
                self.write()
        return await reply_of(task)

    async def stream(
        self, request: StreamRequest, device: str = "ann", number: int | None = None, pairing: bytes = b"first"
    ) -> Reply:
        """Send a stream message and return its reply, which comes at once."""
        task = await self.send(request, device, number, pairing)
        assert task.done()
        return task.result()

    def watch(self, *, age: int = 0, boot: bytes = BOOT) -> StreamRequest:
        return StreamRequest(boot, Watch("", self.tick - age))

    def press(self, hold: int = 1, *, age: int = 0, boot: bytes = BOOT) -> StreamRequest:
        return StreamRequest(boot, Drive("", self.tick - age, hold, 0.2, 0.1))

    def hold(self, action: str = "forward", press: int = 1, *, age: int = 0) -> StreamRequest:
        return StreamRequest(BOOT, HoldAction("", self.tick - age, press, action))

    def stop(self) -> StopRequest:
        return StopRequest(self.new_id())

    def command(
        self, kind: type[Single | CommandRequest], *fields: Any, age: int = 0, boot: bytes = BOOT
    ) -> CommandRequest:
        """Return a new command on the state of `age` ticks ago."""
        if issubclass(kind, CommandRequest):
            return kind(boot, self.new_id(), self.tick - age, *fields)
        own = dict(zip(checks_of(kind), fields, strict=False))
        return tick_request(kind, boot, self.new_id(), self.tick - age, **own)

    def answer(self, action: str = "forward", of: int | None = None) -> CommandRequest:
        return self.command(Teach, action, of)


async def turns(count: int = 5) -> None:
    """Let what can go on go on."""
    for _ in range(count):
        await asyncio.sleep(0)


async def reply_of(task: "asyncio.Task[Reply]") -> Reply:
    """Return the reply of a task that has to be done."""
    await turns()
    assert task.done(), "still waits for its reply"
    return task.result()


def outcome_of(reply: Reply) -> Outcome | None:
    """Return code and fields of a reply; None if it tells none."""
    return outcome_in(reply.body.get("code"), reply.body.get("fields"))


def why(reply: Reply) -> object:
    """Return the wire word of a refusal; "" if there is none."""
    return reply.body.get("why", "")
