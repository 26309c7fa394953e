"""Manual driving over a faulty link."""

import random
from collections.abc import Awaitable, Coroutine
from typing import Any

from kurt2rt.channel.protocol.codec import WireError, decode_request, encode_request
from kurt2rt.channel.protocol.limits import BOOT_BYTES, HIGHEST_SPEED_M_S
from kurt2rt.channel.protocol.requests import DriveRequest
from kurt2rt.channel.server.dependencies import ChannelDependencies, JournalStatus
from kurt2rt.channel.server.reply import Reply, ReplyStatus
from kurt2rt.channel.server.request_handler import RequestHandler, Sender
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.knowledge.files.atomic_write import SavedCopy
from kurt2rt.platform.file_part import FilePart
from kurt2rt.runtime import Runtime
from kurt2rt.teacher.client.manual_drive import BEAT_S

TEACHER = "ann"
_BOOT = bytes(BOOT_BYTES)
_SPEEDS_M_S = (0.3, 0.28)
_SWERVES_EVERY_S = 0.25
_ROUNDING_S = 1e-9


class TeacherLink:
    """Messages of a press, as bytes, from the teacher's device to the robot's request handler.

    They enter after OSCORE, so the rules after it must refuse garbled bytes and copies. off: none arrives. stuck: the
    last one repeats. garbage: random bytes. wrong: well-formed and too fast. slow: few. delayed: late. intermittent: on
    and off.
    """

    def __init__(
        self, time: SimulatedTime, disturbance: RigDisturbance, runtime: Runtime, chance: random.Random
    ) -> None:
        self.refused = 0
        """Messages that were not understood or refused."""
        self._time = time
        self._disturbance = disturbance
        self._chance = chance
        journal = JournalStatus(unsaved=int, saving_error=lambda: None, stamp_of=lambda _: "")
        dependencies = ChannelDependencies(journal, _NoCopies(), str, None, boot=_BOOT)
        self._handler = RequestHandler(runtime, dependencies, {})
        self._number = self._press_id = 0
        self._newest = (0, b"")
        self._passed_at_s = disturbance.begin_s

    def press(self) -> None:
        """Begin a new press, whose id is larger than that of any press before."""
        self._press_id += 1

    def set_displayed_tick(self, tick: int) -> None:
        """Set the tick of the newest state on the teacher's display."""
        self._handler.tick = tick

    def beat(self) -> None:
        """Send the message that is due through the fault of the link; call it every BEAT_S."""
        if not self._press_id:
            return
        disturbance, now_s = self._disturbance, self._time.now_s()
        self._number += 1
        message = (self._number, self._message(*_SPEEDS_M_S))
        if not disturbance.acts(now_s):
            self._newest = message
            self._arrive(*message)
            return
        match disturbance.kind:
            case "off" | "intermittent":
                return
            case "stuck":
                self._arrive(*self._newest)
            case "garbage":
                self._arrive(self._number, self._chance.randbytes(self._chance.randint(0, 40)))
            case "wrong":
                left = int((now_s - disturbance.begin_s) / _SWERVES_EVERY_S) % 2 == 0
                speeds_m_s = (HIGHEST_SPEED_M_S, HIGHEST_SPEED_M_S / 2)
                self._arrive(self._number, self._message(*(speeds_m_s[::-1] if left else speeds_m_s)))
            case "slow":
                if now_s - self._passed_at_s > disturbance.period_s - _ROUNDING_S:
                    self._passed_at_s = now_s
                    self._arrive(*message)
            case "delayed":
                self._time.at(now_s + disturbance.delay_s, lambda: self._arrive(*message))

    def start(self) -> None:
        """Schedule a call of `beat` every BEAT_S of simulated time, without end."""
        self._time.every(BEAT_S, self._time.now_s(), self.beat)

    def _message(self, left_m_s: float, right_m_s: float) -> bytes:
        return encode_request(DriveRequest(_BOOT, self._handler.tick, self._press_id, left_m_s, right_m_s))

    def _arrive(self, number: int, payload: bytes) -> None:
        try:
            request = decode_request(DriveRequest.path, payload)
        except WireError:
            self.refused += 1
            return
        reply = _at_once(self._handler.answer(Sender(TEACHER, b"", number), request))
        if reply.status is not ReplyStatus.DONE:
            self.refused += 1


class _NoCopies:
    """Copies that are never requested (kurt2rt.channel.server.off_tick_requests.Copies)."""

    def save(self, label: str) -> Awaitable[SavedCopy]:
        """Raise NotImplementedError."""
        raise NotImplementedError(label)

    def export(self) -> Awaitable[SavedCopy]:
        """Raise NotImplementedError."""
        raise NotImplementedError

    def package(self) -> Awaitable[SavedCopy]:
        """Raise NotImplementedError."""
        raise NotImplementedError

    def examine(self) -> Awaitable[None]:
        """Raise NotImplementedError."""
        raise NotImplementedError

    def settle(self) -> Awaitable[None]:
        """Raise NotImplementedError."""
        raise NotImplementedError

    def read(self, name: str, offset: int, most_bytes: int) -> Awaitable[FilePart]:
        """Raise NotImplementedError."""
        raise NotImplementedError(name)


def _at_once(answering: Coroutine[Any, Any, Reply]) -> Reply:
    """Return the reply of a request that never waits."""
    try:
        answering.send(None)
    except StopIteration as done:
        reply: Reply = done.value
        return reply
    raise AssertionError("a message of a stream is answered at once")
