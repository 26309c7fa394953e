"""A teacher's device: commands as bytes, over a link that may fail, until the robot's answer comes."""

import asyncio
import itertools
import random
from collections.abc import Iterable
from dataclasses import fields, replace

from kurt2rt.channel.protocol.codec import decode_request, encode_request
from kurt2rt.channel.protocol.requests import Request, StopRequest, StreamRequest, TickRequest, tick_request
from kurt2rt.channel.server.reply import Reply, ReplyStatus
from kurt2rt.channel.server.request_handler import RequestHandler, Sender
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.message_fields import WireError
from kurt2rt.core.teaching.commands import Command, Stream
from kurt2rt.core.tick_record import TickRecord
from tests.stories.channel_judge import ChannelJudge
from tests.stories.fault import FaultInjection
from tests.stories.poor_link import PoorLink
from tests.stories.table import Fault, Target

TEACHER = "eve"
_AGAIN_S = 0.3
_MOST_TRIES = 20
_MOST_GARBAGE = 40
_IDENTITY_BYTES = 8
_OF_THE_DEVICE = ("command_id", "teacher", "seen_tick")
"""Fields of a command that its device fills in."""
Message = tuple[int, str, bytes]
"""Sequence number, path and body."""
Answer = tuple[str, bool]
"""Id of the command, and whether its lesson is durable."""


class Device:
    """Device of one teacher, who sees each tick's state at once.

    Messages enter behind OSCORE, which would refuse copies, so that the rules after it must; answers take the same way.
    page_dies: the device does not ask again for what was open. stuck: the last message repeats. garbage: random bytes.
    """

    def __init__(
        self, injection: FaultInjection, chance: random.Random, teacher: str = TEACHER, target: Target = "link"
    ) -> None:
        self.saved: set[str] = set()
        """Ids of the commands whose lesson the robot said to be durable."""
        self.refused = 0
        """Messages that were not understood, or refused."""
        self.judge = ChannelJudge()
        """Judge of what the robot takes of this and other devices."""
        self._teacher, self._time, self._chance = teacher, injection.time, chance
        self._link = PoorLink(injection, target, chance, self._instead)
        self._answers = PoorLink[Answer](injection, target, chance, lambda _fault, answer, _newest: [answer])
        self._numbers = itertools.count(1)
        self._handler: RequestHandler | None = None
        self._boot = b""
        self._tick = 0
        self._open: dict[str, int] = {}
        """Tries so far of each command without an answer."""
        self._tasks: set[asyncio.Task[None]] = set()

    def connect(self, handler: RequestHandler, boot: bytes) -> None:
        """Talk to another start of the program, which is asked again what the one before did not answer."""
        self._handler, self._boot, self._tick = handler, boot, 0
        self.judge.begin_program(boot)

    def forget(self) -> None:
        """Forget the commands without an answer, as a page does that dies."""
        self._open.clear()

    def disconnect(self) -> None:
        """End the talk with a program that is over."""
        self._handler = None
        for task in self._tasks:
            task.cancel()

    async def wait(self) -> None:
        """Wait until no answer is under way any more; call it after `disconnect`."""
        await asyncio.gather(*self._tasks, return_exceptions=True)

    @property
    def waits(self) -> bool:
        """Return whether the robot works on an answer."""
        return bool(self._tasks)

    def see(self, record: TickRecord) -> None:
        """Let the teacher see the state of this tick."""
        self._tick = record.tick
        self.judge.on_tick(record.tick, by_hand=record.decision.cause is DecisionCause.TEACHER)

    def send(self, command: Command) -> None:
        """Send a message of a stream once, a command until it is answered."""
        if isinstance(command, Stream):
            request = StreamRequest(self._boot, replace(command, teacher=""))
            self._link.carry((next(self._numbers), command.path, encode_request(request)), self._arrive)
            return
        identity = self._chance.randbytes(_IDENTITY_BYTES)
        own = {each.name: getattr(command, each.name) for each in fields(command) if each.name not in _OF_THE_DEVICE}
        body = encode_request(tick_request(type(command), self._boot, identity, self._tick, **own))
        self._open[identity.hex()] = 0
        self._try(identity.hex(), command.path, body)

    def _try(self, identity: str, path: str, body: bytes) -> None:
        tries = self._open.get(identity)
        if tries is None or tries >= _MOST_TRIES:
            self._open.pop(identity, None)
            return
        self._open[identity] = tries + 1
        self._link.carry((next(self._numbers), path, body), self._arrive)
        self._time.at(self._time.now_s() + _AGAIN_S, lambda: self._try(identity, path, body))

    def _instead(self, fault: Fault, message: Message, newest: Message) -> Iterable[Message]:
        match fault.kind:
            case "garbage":
                return [(*message[:2], self._chance.randbytes(self._chance.randint(0, _MOST_GARBAGE)))]
            case "stuck":
                return [newest]
        return [message]

    def _arrive(self, message: Message) -> None:
        handler = self._handler
        if handler is None:
            return
        number, path, body = message
        try:
            request = decode_request(path, body)
        except WireError:
            self.refused += 1
            return
        self.judge.heard_at_s = self._time.now_s()
        task = asyncio.get_running_loop().create_task(
            self._answered(handler, Sender(self._teacher, b"", number), request)
        )
        self._tasks.add(task)
        task.add_done_callback(self._on_answered)

    def _on_answered(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            self.judge.problems.append(f"an answer ended by {error!r}")

    async def _answered(self, handler: RequestHandler, sender: Sender, request: Request) -> None:
        tick = handler.tick
        reply: Reply = await handler.answer(sender, request)
        self.judge.on_reply(sender, request, tick, reply)
        self.refused += reply.status is not ReplyStatus.DONE
        if isinstance(request, TickRequest | StopRequest):
            # If the answer is lost, the command comes again.
            is_saved = reply.status is ReplyStatus.DONE and reply.body.get("row") is not None
            self._answers.carry((request.command_id.hex(), is_saved), self._take_answer)

    def _take_answer(self, answer: Answer) -> None:
        identity, is_saved = answer
        self._open.pop(identity, None)
        if is_saved:
            self.saved.add(f"{self._teacher}-{identity}")
