"""Teacher's device in Python: see the robot, teach it and drive it over the network.

async with TeacherClient(Path("var/devices/phone")) as robot:
    await robot.send(Take)
    async for state in robot.states():
        if state.cause == "unknown":
            await robot.send(Teach, action="forward", decision_tick=state.tick)
"""

import hashlib
import secrets
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from typing import Any

import anyio

from kurt2rt.channel.protocol.limits import UPLOAD_ID_BYTES, UPLOAD_PART_BYTES
from kurt2rt.channel.protocol.requests import CommandRequest, LoadRequest, UploadRequest
from kurt2rt.core.teaching.commands import Correct, Resume, RunBehaviour, Single, Stop, Take, TeachShown
from kurt2rt.teacher.client.answer import Answer, RefusedError
from kurt2rt.teacher.client.manual_drive import PressHandle
from kurt2rt.teacher.client.observer_client import ObserverClient

_SEEN_IN_CHARGE_WITHIN_S = 1.0
_REWIND_S = 60.0
"""Driving that a robot keeps for late lessons, in s (6000 ticks)."""
_PART_EACH_S = 0.008


class TeacherClient(ObserverClient):
    """Async context manager that connects a teacher's device to one robot.

    Inside it states come in. While this device is in charge, it reports its teacher's presence to the robot.

    Commands are sent again every 0.1 s, count once, and return the robot's `Answer`; a refusal is an Answer too. They
    raise NoAnswerError after 3.5 s without an answer; it is then unknown whether they counted. `stop` overtakes every
    other command. Only one program at a time can use a pairing.
    """

    async def send(self, kind: type[Single | CommandRequest], /, **fields: Any) -> Answer:
        """Send a command; a stop that comes before the answer refuses a command that may move the robot.

        `Take` returns when the robot knows that its teacher is there. `Resume` and `RunBehaviour` end a stop that is
        still being sent.

        Args:
            kind: Class of the command, of core/teaching/commands.py or channel/protocol/requests.py.
            fields: Fields of the class that have a check. `decision_tick` is the tick of the state that is meant; None:
                the present decision. The client adds the others, such as the id and the state that was seen.

        Raises:
            NoAnswerError: The robot does not answer.
            TypeError: The class has other fields.
        """
        if kind is Stop:
            return await self.stop()
        if kind in (Resume, RunBehaviour):
            self._open.stops.supersede()
        sender = self._open.sender
        if not kind.moves:
            return await sender.command(kind, **fields)
        answer = await self._open.stops.move(kind.path.strip("/"), lambda: sender.command(kind, **fields))
        if kind is Take and answer.accepted:
            with anyio.move_on_after(_SEEN_IN_CHARGE_WITHIN_S):
                async for state in self.states():
                    if state.teacher == self.name:
                        self._drive.beat()
                        break
        return answer

    # Motion

    async def stop(self) -> Answer:
        """Stop the robot; always allowed. It ends a press.

        Commands that move the robot and wait for their answer are sent no more; they return a refusal with the `why`
        "stopped". Raises NoAnswerError if the robot does not answer; the stop is then sent on until it does
        (`stop_pending`).
        """
        self._drive.end()
        return await self._open.stops.stop()

    @property
    def stop_pending(self) -> bool:
        """True while an unanswered stop is being sent: until its answer, `Resume`, `run` or a press."""
        return self._open.stops.pending

    async def run(self, action: str, seconds: float) -> Answer:
        """Run one action of the repertoire for `seconds` of robot time; the robot stands afterwards.

        Returns as soon as the action begins. Raises NoAnswerError.
        """
        self._open.stops.supersede()

        async def begin() -> Answer:
            ticks = await self._ticks(seconds)
            return await self._open.sender.command(RunBehaviour, action=action, ticks=ticks)

        # A stop also ends the wait for the length of a tick.
        return await self._open.stops.move(action, begin)

    @property
    def pressing(self) -> bool:
        """True while a press is on."""
        return self._drive.press_id is not None

    @property
    def refusal(self) -> Answer | None:
        """Refusal that ended the last press, or kept it from beginning; None if there is none."""
        return self._drive.refusal

    def press(self, left_m_s: float, right_m_s: float) -> bool:
        """Begin a press or change its speeds; return whether a press is on.

        The press ends if the robot refuses it, or if no state came for 0.5 s; the next call then begins another one.
        Raises WireError for speeds out of range.
        """
        return self._drive.press((left_m_s, right_m_s))

    def press_action(self, action: str) -> bool:
        """Begin to hold an action, or hold another one in the present press; return whether a press is on.

        The robot does the action and is taught it on the way, until `let_go`. Raises WireError for a name that cannot
        be sent.
        """
        return self._drive.press(action)

    async def let_go(self) -> Answer | None:
        """End the press that is on, and return the robot's answer; None if no press is on.

        The press is over before this waits for the answer, and a later press is not ended. After a held action the
        robot drives on by its RLAs, and the answer tells how many lessons it gave; after manual drive it stands. Raises
        NoAnswerError; the robot then ends the press by itself after its deadman time.
        """
        return await self._open.end_press(self._drive.press_id)

    @asynccontextmanager
    async def driving(self) -> AsyncIterator[PressHandle]:
        """Drive by hand inside the block; the press begins with the first speeds and ends with a stop.

        Raises NoAnswerError at the end of the block if the stop is not answered.
        """
        handle = PressHandle(self._drive)
        async with self._open.ending(handle):
            yield handle

    async def hold_for(self, action: str, seconds: float) -> Answer:
        """Hold an action for a time: the robot does it, is taught it on the way, and then drives on by its RLAs.

        Each 0.1 s becomes a lesson, unless the robot would do that action there by itself; the lessons are undone
        together.

        Returns:
            Answer to the release, with the number of lessons; the refusal of a hold that ended before its time.

        Raises:
            NoAnswerError: The release is not answered.
            WireError: The name cannot be sent.
        """
        handle = PressHandle(self._drive)
        handle.set(action)
        async with self._open.ending(handle):
            await handle.wait(seconds)
        ended = handle.released or handle.ended or self._drive.refusal
        assert ended is not None, "a hold that is not released was refused"
        return ended

    # Lessons

    async def correct_earlier(self, action: str, seconds: float) -> Answer:
        """Correct what the basic level did `seconds` before it last drove (rewind).

        A robot keeps its last minute of driving, however long it has stood since or between.

        Raises:
            ValueError: `seconds` is not between 0 and 60, or no state of a driving robot came yet.
            NoAnswerError: the robot does not answer.
        """
        if not 0.0 <= seconds <= _REWIND_S:
            raise ValueError(f"seconds: a robot keeps the last {_REWIND_S:g} s of driving (got {seconds:g})")
        stream = self._stream
        tick = None if stream.tick_before(0) is None else stream.tick_before(await self._ticks(seconds))
        if tick is None:
            raise ValueError("this device has not seen the robot drive; correct what it does from now on")
        return await self.send(Correct, action=action, decision_tick=tick)

    async def teach_shown(self, segments: Sequence[int] | None = None) -> Answer:
        """Teach the newest drive by hand, as `State.shown` cuts it into actions; undone as one.

        `segments`: indexes of those that are right; None: all.

        Raises:
            ValueError: The newest state has no drive by hand to teach.
            NoAnswerError: The robot does not answer.
        """
        shown = None if self.state is None else self.state.shown
        if shown is None:
            raise ValueError("there is no drive by hand to teach; drive by hand and let go first")
        chosen = tuple(range(len(shown.actions)) if segments is None else segments)
        return await self.send(TeachShown, press_id=shown.press_id, segments=chosen)

    # Knowledge for the next run of a simulated robot

    async def load(self, content: bytes) -> Answer:
        """Upload knowledge at up to 100 kB/s and begin the next run with it.

        `content` is an archive of an export or a knowledge file. Raises NoAnswerError.
        """
        upload = secrets.token_bytes(UPLOAD_ID_BYTES)
        try:
            await self.upload(upload, content)
        except RefusedError as error:
            return error.answer or Answer(False, "refused", str(error), -1)
        return await self.send(LoadRequest, upload=upload, sha256=hashlib.sha256(content).digest())

    async def upload(self, upload: bytes, content: bytes) -> None:
        """Upload a file into the robot's memory under the random id `upload`, for a `LoadRequest`.

        Raises RefusedError if the robot refuses a part, NoAnswerError.
        """
        sender = self._open.sender
        state = await sender.state()
        for offset in range(0, len(content), UPLOAD_PART_BYTES):
            part = content[offset : offset + UPLOAD_PART_BYTES]
            began_s = self._now()
            answer = await sender.send(UploadRequest(state.boot, upload, offset, part))
            if not answer.accepted:
                raise RefusedError(answer.text or answer.why, answer)
            # The robot drops more than 200 requests a second of one key.
            await anyio.sleep(max(0.0, _PART_EACH_S - (self._now() - began_s)))
