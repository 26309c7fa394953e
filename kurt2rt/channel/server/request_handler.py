"""The rules by which the robot takes what its teachers send. Who sent it is certain here; when and why is not."""

import asyncio
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from hal.simulation import SimulatedWorld
from kurt2rt.channel.protocol.exam_status import ExamStatus
from kurt2rt.channel.protocol.facts_codec import plain_of_facts
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.health_codec import plain_of
from kurt2rt.channel.protocol.requests import (
    MOST_SITUATIONS,
    BehaviourRequest,
    CommandRequest,
    DriveRequest,
    HealthRequest,
    HelloRequest,
    LessonsRequest,
    PursueRequest,
    Request,
    ResumeRequest,
    SeekLikeRequest,
    SeekRequest,
    SeekRlaRequest,
    SituationsRequest,
    StopRequest,
    StreamRequest,
    TakeRequest,
    WhyRequest,
)
from kurt2rt.channel.server.command_of import command_of
from kurt2rt.channel.server.device_rate_limit import PerDeviceRateLimit
from kurt2rt.channel.server.off_tick_requests import Copies, OffTickCommand, OffTickRequests
from kurt2rt.channel.server.pending_commands import PendingCommands
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, refusal, restarted, unsaved
from kurt2rt.channel.server.simulation import ProgressMeter, RunControl
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Command, Drive, Stop, Watch
from kurt2rt.core.teaching.inbox import InboxFullError
from kurt2rt.platform.simulated_clock import Speed
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.runtime import Runtime

STREAM_TICKS = 40
"""A message of a stream on an older picture is refused: it was held back on its way."""
MOVING_TICKS = 100
COMMAND_TICKS = 300
_SEEKING = (SeekRequest, SeekRlaRequest, SeekLikeRequest)
_MOVING = (BehaviourRequest, PursueRequest, ResumeRequest, TakeRequest, *_SEEKING)
MOST_WHYS, WHY_EVERY_TICKS = 5, 10
"""An answer takes about a millisecond of the loop; a device says it again every 0.1 s until it is answered."""
LONGEST_WAIT_S = 3.0
"""Then a lesson that is not durable yet is answered as unsaved."""


class Sender(NamedTuple):
    """Whose message it is, for certain."""

    device: str
    pairing: bytes
    """Of the device; another one after it was renewed."""
    number: int
    """Grows with each message of a pairing."""


class RequestHandler:
    """Takes requests in the robot's own loop, between two ticks."""

    def __init__(
        self,
        runtime: Runtime,
        boot: bytes,
        hello: Mapping[str, Any],
        stamp_of: Callable[[str], str],
        copies: Copies,
        ground: SimulatedWorld | None,
        *,
        longest_wait_s: float = LONGEST_WAIT_S,
        health: Callable[[], HealthReport | None] = lambda: None,
        why: Callable[[], DecisionFacts | None] = lambda: None,
        exam: Callable[[], ExamStatus] | None = None,
        simulation: RunControl | None = None,
        speed: Speed | None = None,
        measure: ProgressMeter | None = None,
    ) -> None:
        """`boot`: random bytes of this start. `stamp_of`: when the lesson of a command became durable, or nothing.

        `health`: the newest report; None before the first. `why`: facts of the newest decision; None before it.
        `exam`: how the exam stands; None where the robot is not examined. `simulation`: None where the simulator is not
        in this program. `speed`: None where robot time is real time.
        `measure`: None where nothing is measured.
        """
        self._runtime = runtime
        self._boot = boot
        self._hello = hello
        self._stamp_of = stamp_of
        self._longest_wait_s = longest_wait_s
        self._health = health
        self._why = why
        self._whys = PerDeviceRateLimit(MOST_WHYS, WHY_EVERY_TICKS)
        self._outcomes = PendingCommands()
        self._newest: dict[str, Sender] = {}
        self.tick = 0
        """Of the newest picture."""
        self._off_tick = OffTickRequests(
            runtime, boot, self._outcomes, lambda: self.tick, copies, ground, exam, simulation, speed, measure
        )

    def close(self) -> None:
        """Give up the copies that are being made."""
        self._off_tick.close()

    def settle(self, command_id: str, reply: Reply) -> None:
        """What became of a command that had come in."""
        self._outcomes.settle(command_id, reply)

    async def answer(self, sender: Sender, request: Request) -> Reply:
        """The reply to a request."""
        device = sender.device
        match request:
            case StreamRequest():
                return self._stream(sender, request)
            case StopRequest(command_id=identity, press_id=press_id):
                return await self._stop(sender, f"{device}-{identity.hex()}", press_id)
            case CommandRequest():
                return await self._command(device, request)
            case HelloRequest():
                return Reply(ReplyStatus.DONE, {**self._hello, "tick": self.tick})
            case LessonsRequest(count=count):
                return Reply(ReplyStatus.DONE, {"lessons": self._lessons(count)})
            case SituationsRequest():
                return Reply(ReplyStatus.DONE, {"situations": self._situations()})
            case HealthRequest():
                health = self._health()
                return Reply(ReplyStatus.DONE, {"health": None if health is None else plain_of(health)})
            case WhyRequest():
                if not self._whys.take(sender.device, self.tick):
                    return refusal("refused", Outcome(RefusalCode.TOO_OFTEN), self.tick)
                facts = self._why()
                return Reply(ReplyStatus.DONE, {"why": None if facts is None else plain_of_facts(facts)})
        return await self._off_tick.answer(device, request)

    def _stream(self, sender: Sender, request: StreamRequest) -> Reply:
        tick, school, device = self.tick, self._runtime.handler, sender.device
        stale = self._stale(request.boot, request.seen, STREAM_TICKS)
        if stale is not None:
            return stale
        if not self._is_newest(sender):
            return refusal("old", Outcome(RefusalCode.OVERTAKEN), tick)
        command: Watch | Drive = Watch(device, request.seen)
        if isinstance(request, DriveRequest):
            command = Drive(device, request.seen, request.press_id, request.left_m_s, request.right_m_s)
        held = school.authority.refusal_for(device)
        if held is not None:
            return refusal("held", held, tick)
        ended = school.manual_refusal(command)
        if ended is not None:
            return refusal("stopped", ended, tick)
        return Reply(ReplyStatus.DONE, {"t": tick}) if self._hand_in(command) else self._too_many()

    async def _stop(self, sender: Sender, command_id: str, press_id: int | None) -> Reply:
        # What of a press was sent before the stop and comes after it is over, too.
        self._is_newest(sender)
        # Each copy stops again, whatever came of the one before: the robot may have been told to drive meanwhile.
        if not self._hand_in(Stop(command_id, sender.device, press_id)):
            return self._too_many()
        # Shielded: the end of one copy's request must not end what the next copy waits for.
        return await asyncio.shield(self._outcomes.get(command_id) or self._outcomes.begin(command_id))

    async def _command(self, device: str, request: CommandRequest) -> Reply:
        command_id = f"{device}-{request.command_id.hex()}"
        waiting = self._outcomes.get(command_id)
        if waiting is None:
            if self._runtime.handler.was_handled(command_id):  # before this start of the program, or long ago
                return done(self.tick, Outcome(ResultCode.REPEATED))
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
            return unsaved(Outcome(RefusalCode.NOT_SAVED_YET), self.tick)

    def _begin(self, device: str, command_id: str, request: CommandRequest) -> Reply | None:
        """Hand a command to the next tick, or carry out one that is not the tick's; a reply where that ends it."""
        if isinstance(request, OffTickCommand):
            return self._off_tick.begin(device, command_id, request)
        held = self._runtime.handler.authority.refusal_for(device)
        if held is not None and not isinstance(request, TakeRequest):
            return refusal("held", held, self.tick)
        self._outcomes.begin(command_id)
        if not self._hand_in(command_of(device, command_id, request)):
            reply = self._too_many()
            self._outcomes.settle(command_id, reply)
        return None

    def _is_newest(self, sender: Sender) -> bool:
        """Whether nothing newer came from this device; notes it."""
        newest = self._newest.get(sender.device)
        if newest is not None and newest.pairing == sender.pairing and sender.number <= newest.number:
            return False
        self._newest[sender.device] = sender
        return True

    def _stale(self, boot: bytes, seen: int, longest: int) -> Reply | None:
        if boot != self._boot:
            return restarted(self.tick)
        # So long in real time, which is the teacher's, at any speed of a simulation.
        if not 0 <= self.tick - seen <= longest * self._runtime.handler.authority.speed:
            return refusal("stale", Outcome(RefusalCode.OLD_PICTURE), self.tick)
        return None

    def _hand_in(self, command: Command) -> bool:
        try:
            self._runtime.inbox.put(command)
        except InboxFullError:
            return False
        return True

    def _too_many(self) -> Reply:
        return refusal("refused", Outcome(RefusalCode.TOO_MANY), self.tick)

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
        return sorted(self._runtime.level.system.named_situations(MID))[:MOST_SITUATIONS]
