"""A second teacher who drives by hand over a link that may fail."""

import math
import random
from collections.abc import Coroutine
from typing import Any

from kurt2rt.channel.protocol.codec import decode_request, encode_request
from kurt2rt.channel.protocol.requests import StreamRequest
from kurt2rt.channel.server.reply import Reply, ReplyStatus
from kurt2rt.channel.server.request_handler import RequestHandler, Sender
from kurt2rt.core.message_fields import WireError
from kurt2rt.core.teaching.commands import Drive
from kurt2rt.core.teaching.message_fields import HIGHEST_SPEED_M_S
from kurt2rt.teacher.client.manual_drive import BEAT_S
from tests.stories.channel_judge import ChannelJudge
from tests.stories.fault import FaultInjection

DRIVER = "ann"
_SPEEDS_M_S = (0.3, 0.28)
_SWERVES_EVERY_S = 0.25
_ROUNDING_S = 1e-9


class Hand:
    """Messages of a press, as bytes, from the teacher's device to the robot's request handler.

    They enter after OSCORE, so the rules after it must refuse garbled bytes and copies. off: none arrives. stuck: the
    last one repeats. garbage: random bytes. wrong: well-formed and too fast. slow: few. delayed: late. intermittent: on
    and off.
    """

    def __init__(
        self,
        handler: RequestHandler,
        boot: bytes,
        injection: FaultInjection,
        chance: random.Random,
        press_id: int,
        judge: ChannelJudge,
    ) -> None:
        """Begin to press; `press_id` is larger than that of any press before. `boot`: id of the program's start."""
        self.heard_at_s = -math.inf
        """Time at which the newest message that the robot understood arrived there."""
        self.refused = 0
        """Messages that were not understood or refused."""
        self._press_id = press_id
        self._injection, self._time, self._chance = injection, injection.time, chance
        self._handler: RequestHandler | None = handler
        self._boot, self._judge = boot, judge
        self._number = 0
        self._newest = (0, b"")
        self._passed_at_s = 0.0
        self._is_over = False
        self._beat()

    def press_again(self) -> None:
        self._press_id += 1

    def let_go(self) -> None:
        """Send no more messages."""
        self._is_over = True

    def disconnect(self) -> None:
        """End with the program that it drives: nothing arrives there any more."""
        self._is_over, self._handler = True, None

    def _beat(self) -> None:
        """Send the message that is due through the fault of the link."""
        if self._is_over:
            return
        fault, now_s = self._injection.acting_on("teacher_link"), self._time.now_s()
        self._time.at(now_s + BEAT_S, self._beat)
        self._number += 1
        message = (self._number, self._message(*_SPEEDS_M_S))
        if fault is None:
            self._newest = message
            self._arrive(*message)
            return
        match fault.kind:
            case "sound":
                self._newest = message
                self._arrive(*message)
            case "off" | "intermittent":
                return
            case "stuck":
                self._arrive(*self._newest)
            case "garbage":
                self._arrive(self._number, self._chance.randbytes(self._chance.randint(0, 40)))
            case "wrong":
                left = int((now_s - fault.begin_s) / _SWERVES_EVERY_S) % 2 == 0
                speeds_m_s = (HIGHEST_SPEED_M_S, HIGHEST_SPEED_M_S / 2)
                self._arrive(self._number, self._message(*(speeds_m_s[::-1] if left else speeds_m_s)))
            case "slow":
                if now_s - max(self._passed_at_s, fault.begin_s) > fault.period_s - _ROUNDING_S:
                    self._passed_at_s = now_s
                    self._arrive(*message)
            case "delayed":
                self._time.at(now_s + fault.delay_s, lambda: self._arrive(*message))
            case "reordered":
                self._time.at(now_s + self._chance.uniform(0.0, fault.delay_s), lambda: self._arrive(*message))

    def _message(self, left_m_s: float, right_m_s: float) -> bytes:
        assert self._handler is not None, "a hand without a program sends nothing"
        return encode_request(
            StreamRequest(self._boot, Drive("", self._handler.tick, self._press_id, left_m_s, right_m_s))
        )

    def _arrive(self, number: int, payload: bytes) -> None:
        handler = self._handler
        if handler is None:
            return
        try:
            request = decode_request(Drive.path, payload)
        except WireError:
            self.refused += 1
            return
        self.heard_at_s = self._time.now_s()
        sender, tick = Sender(DRIVER, b"", number), handler.tick
        reply = _at_once(handler.answer(sender, request))
        self._judge.on_reply(sender, request, tick, reply)
        self.refused += reply.status is not ReplyStatus.DONE


def _at_once(answering: Coroutine[Any, Any, Reply]) -> Reply:
    """Return the reply of a request that never waits."""
    try:
        answering.send(None)
    except StopIteration as done:
        reply: Reply = done.value
        return reply
    raise AssertionError("a message of a stream is answered at once")
