"""Rules for requests of authenticated teachers: age, order, authority, idempotency."""

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from hal import points
from kurt2rt.channel.protocol.codec import FACTS
from kurt2rt.channel.protocol.health import HEALTH
from kurt2rt.channel.protocol.hello import HELLO, Hello
from kurt2rt.channel.protocol.lesson_list import LESSONS, SITUATIONS
from kurt2rt.channel.protocol.requests import (
    CommandRequest,
    HealthRequest,
    HelloRequest,
    LessonsRequest,
    Request,
    SituationsRequest,
    StopRequest,
    StreamRequest,
    TickRequest,
    WhyRequest,
)
from kurt2rt.channel.server.datagram_filter import PerDeviceRateLimit
from kurt2rt.channel.server.dependencies import ChannelDependencies
from kurt2rt.channel.server.lesson_list import LessonList
from kurt2rt.channel.server.off_tick_requests import OffTickCommand, OffTickRequests, PendingCommands
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, refusal, restarted, unsaved
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Command, Stop, Stream, Take
from kurt2rt.core.teaching.inbox import InboxFullError
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.runtime import Runtime

STREAM_TICKS = 40
"""Largest age of the state behind a stream message; an older one was held back by the network."""
MOVING_TICKS = 100
COMMAND_TICKS = 300
MOST_WHYS, WHY_EVERY_TICKS = 5, 10
"""Limit for /why, whose answer takes about a millisecond of the loop; a device asks again every 0.1 s."""
LONGEST_WAIT_S = 3.0
"""Time after which a lesson that is not durable yet is answered as unsaved."""


class Sender(NamedTuple):
    """Authenticated sender of a request, by the key that protected it, and the request's sequence number."""

    device: str
    pairing: bytes
    """Id of the device's pairing; it changes when the pairing is renewed."""
    number: int
    """Sequence number, which grows with each message of a pairing."""


class RequestHandler:
    """Handler of authenticated requests, in the robot's own loop: queues commands, answers queries."""

    def __init__(
        self,
        runtime: Runtime,
        parts: ChannelDependencies,
        hello: Hello,
        *,
        why: Callable[[], DecisionFacts | None] = lambda: None,
        longest_wait_s: float = LONGEST_WAIT_S,
    ) -> None:
        """Begin without pending commands.

        Args:
            runtime: The robot.
            parts: Parts of the service.
            hello: Description of the robot.
            why: Facts of the newest decision; None before it.
            longest_wait_s: Time after which a lesson that is not durable yet is answered as unsaved, in seconds.
        """
        self._runtime = runtime
        self._parts = parts
        self._hello: Mapping[str, Any] = HELLO.plain_of(hello)
        self._longest_wait_s = longest_wait_s
        self._why = why
        self._whys = PerDeviceRateLimit(MOST_WHYS, WHY_EVERY_TICKS)
        self._pending = PendingCommands()
        self._newest: dict[str, Sender] = {}
        self.tick = 0
        """Tick of the newest state."""
        self.lessons = LessonList(runtime.level.system, parts.journal.stamp_of, runtime.action_groups())
        """Newest lessons, and those that contradict their neighbours."""
        self._off_tick = OffTickRequests(runtime, parts, self._pending, lambda: self.tick)

    def close(self) -> None:
        """Cancel the work off the tick that is under way."""
        self._off_tick.close()

    def settle(self, command_id: str, reply: Reply) -> None:
        """Resolve the reply to a pending command; do nothing for an id that is not pending."""
        self._pending.settle(command_id, reply)

    def lesson_of(self, command_id: str) -> str | None:
        """Return the id that undoes the lesson of a command; None if the command gave no lesson."""
        return None if self._runtime.level.system.history.get(command_id) is None else command_id

    async def answer(self, sender: Sender, request: Request) -> Reply:
        """Return the reply to a request of an authenticated sender; refusals are replies, too.

        It waits for the tick that takes a command, and until a lesson is durable, at most `longest_wait_s`.
        """
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
                return Reply(ReplyStatus.DONE, {"lessons": LESSONS.plain_of(tuple(self.lessons.newest(count)))})
            case SituationsRequest():
                return Reply(ReplyStatus.DONE, {"situations": SITUATIONS.plain_of(self._situations())})
            case HealthRequest():
                health = self._parts.health()
                return Reply(ReplyStatus.DONE, {"health": None if health is None else HEALTH.plain_of(health)})
            case WhyRequest():
                if not self._whys.acquire(sender.device, self.tick):
                    return refusal("refused", Outcome(RefusalCode.TOO_OFTEN), self.tick)
                facts = self._why()
                return Reply(ReplyStatus.DONE, {"why": None if facts is None else FACTS.plain_of(facts)})
        return await self._off_tick.answer(device, request)

    def _stream(self, sender: Sender, request: StreamRequest) -> Reply:
        tick, commands, device = self.tick, self._runtime.handler, sender.device
        stale = self._stale(request.boot, request.command.seen_tick, STREAM_TICKS)
        if stale is not None:
            return stale
        if not self._is_newest(sender):
            return refusal("old", Outcome(RefusalCode.OVERTAKEN), tick)
        command: Stream = replace(request.command, teacher=device)
        held = commands.authority.refusal_for(device)
        if held is not None:
            return refusal("held", held, tick)
        ended = commands.control.press_refusal(command)
        if ended is not None:
            return refusal("refused" if ended.code is RefusalCode.NO_ACTION else "stopped", ended, tick)
        return Reply(ReplyStatus.DONE, {"t": tick}) if self._enqueue(command) else self._too_many()

    async def _stop(self, sender: Sender, command_id: str, press_id: int | None) -> Reply:
        # Drive messages that were sent before the stop and arrive after it count as overtaken.
        self._is_newest(sender)
        # Each copy stops the robot again, because it may have been resumed since the first copy.
        if not self._enqueue(Stop(command_id, sender.device, press_id)):
            return self._too_many()
        # Shielded: cancelling the request of one copy must not cancel the reply for the next copy.
        return await asyncio.shield(self._pending.get(command_id) or self._pending.begin(command_id))

    async def _command(self, device: str, request: CommandRequest) -> Reply:
        command_id = f"{device}-{request.command_id.hex()}"
        waiting = self._pending.get(command_id)
        if waiting is None:
            if self._runtime.handler.was_handled(command_id):  # before this start of the program, or long ago
                return done(self.tick, Outcome(ResultCode.REPEATED), lesson=self.lesson_of(command_id))
            moves = request.command.moves if isinstance(request, TickRequest) else request.moves
            longest = MOVING_TICKS if moves else COMMAND_TICKS
            stale = self._stale(request.boot, request.seen, longest)
            if stale is not None:
                return stale
            reply = self._begin(device, command_id, request)
            if reply is not None:
                return reply
            waiting = self._pending.get(command_id)
            assert waiting is not None
        try:
            return await asyncio.wait_for(asyncio.shield(waiting), self._longest_wait_s)
        except TimeoutError:
            return unsaved(Outcome(RefusalCode.NOT_SAVED_YET), self.tick)

    def _begin(self, device: str, command_id: str, request: CommandRequest) -> Reply | None:
        """Queue a command for the next tick, or begin it off the tick; return a refusal if there is one."""
        if isinstance(request, OffTickCommand):
            return self._off_tick.begin(device, command_id, request)
        assert isinstance(request, TickRequest), f"{type(request).__name__} is no command for the tick"
        held = self._runtime.handler.authority.refusal_for(device)
        if held is not None and not isinstance(request.command, Take):
            return refusal("held", held, self.tick)
        self._pending.begin(command_id)
        if not self._enqueue(replace(request.command, command_id=command_id, teacher=device)):
            reply = self._too_many()
            self._pending.settle(command_id, reply)
        return None

    def _is_newest(self, sender: Sender) -> bool:
        """Note a message; return whether it is the newest of its device."""
        newest = self._newest.get(sender.device)
        if newest is not None and newest.pairing == sender.pairing and sender.number <= newest.number:
            return False
        self._newest[sender.device] = sender
        return True

    def _stale(self, boot: bytes, seen: int, longest: int) -> Reply | None:
        if boot != self._parts.boot:
            return restarted(self.tick)
        # The limits are in the teacher's real time, at any speed of a simulation.
        is_new = 0 <= self.tick - seen <= longest * self._runtime.handler.authority.speed
        if not is_new or points.happens("a picture is old"):
            return refusal("stale", Outcome(RefusalCode.OLD_PICTURE), self.tick)
        return None

    def _enqueue(self, command: Command) -> bool:
        try:
            self._runtime.inbox.put(command)
        except InboxFullError:
            return False
        return True

    def _too_many(self) -> Reply:
        return refusal("refused", Outcome(RefusalCode.TOO_MANY), self.tick)

    def _situations(self) -> tuple[str, ...]:
        return tuple(sorted(self._runtime.level.system.named_situations(MID)))
