"""Teacher's device in Python: see the robot, teach it and drive it over the network.

async with TeacherClient(Path("var/devices/phone")) as robot:
    await robot.take()
    async for state in robot.states():
        if state.cause == "unknown":
            await robot.answer("forward", of=state.tick)
"""

import hashlib
import secrets
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from typing import Any

import anyio

from kurt2rt.channel.protocol import requests
from kurt2rt.channel.protocol.limits import UPLOAD_ID_BYTES, UPLOAD_PART_BYTES
from kurt2rt.channel.protocol.request_types import Request
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.teacher.client.answer import Answer, RefusedError
from kurt2rt.teacher.client.manual_drive import HoldHandle, ManualDriveHandle
from kurt2rt.teacher.client.observer_client import ObserverClient

_REWIND_S = 10.0
"""Driving that a robot keeps for late lessons, in s (1000 ticks)."""
_PART_EACH_S = 0.008
_SEEN_IN_CHARGE_WITHIN_S = 1.0


class TeacherClient(ObserverClient):
    """Async context manager that connects a teacher's device to one robot.

    Inside it states come in. While this device is in charge, the robot is told that its teacher is there.

    Commands are sent again every 0.1 s, count once, and return the robot's `Answer`; a refusal is an Answer too. They
    raise NoAnswerError after 3.5 s without an answer; it is then unknown whether they counted. `stop` overtakes every
    other command. Lessons take the tick of the state that is meant as `of`; None: the present decision. Only one
    program at a time can use a pairing.
    """

    # Lessons

    async def answer(
        self, action: str, *, of: int | None = None, level: str = BASIC, alternative: bool = False
    ) -> Answer:
        """Answer the robot's question with an action: a new RLA (phase 1).

        Args:
            action: Action of the repertoire; at level MID a taught behaviour.
            of: Tick of the state that is meant. None: the present decision.
            level: BASIC or MID.
            alternative: Add the behaviour to those that the mid level knows for this situation.

        Raises:
            NoAnswerError: The robot does not answer.
        """
        return await self._command(
            requests.AnswerRequest, action=action, decision_tick=of, level=level, alternative=alternative
        )

    async def correct(self, action: str, *, of: int | None = None, level: str = BASIC, late: bool = False) -> Answer:
        """Replace the decided action by another one (phase 2), at level MID the behaviour.

        Args:
            action: Right action of the repertoire; at level MID a taught behaviour.
            of: Tick of the state that is meant. None: the present decision.
            level: BASIC or MID.
            late: Correct the decision that a person reacted to, before the state of `of` by their delay, which the
                robot learns from their answers to its questions. The answer says which decision it was.

        Raises:
            NoAnswerError: The robot does not answer.
        """
        return await self._command(requests.CorrectRequest, action=action, decision_tick=of, level=level, late=late)

    async def correct_earlier(self, action: str, seconds: float) -> Answer:
        """Correct what the basic level did `seconds` before it last drove (rewind).

        A standing robot keeps its last 10 s of driving until it has driven and stopped again.

        Raises:
            ValueError: `seconds` is not between 0 and 10, or no state of a driving robot came yet.
            NoAnswerError: the robot does not answer.
        """
        if not 0.0 <= seconds <= _REWIND_S:
            raise ValueError(f"seconds: a robot keeps the last {_REWIND_S:g} s of driving (got {seconds:g})")
        drove = self._stream.drove_tick
        if drove is None:
            raise ValueError("this device has not seen the robot drive; correct what it does from now on")
        return await self.correct(action, of=max(0, drove - await self._ticks(seconds)))

    async def reward(self, value: int, *, of: int | None = None) -> Answer:
        """Reward what the robot did (phase 3).

        `value`: -1 or +1. `of`: tick of the state that is meant; None: the present decision. Raises NoAnswerError.
        """
        return await self._command(requests.RewardRequest, value=value, decision_tick=of)

    async def appraise(self, appraisal: str, *, of: int | None = None) -> Answer:
        """Teach the critic the value of a situation (phase 4): a name of `Hello.appraisals`.

        `of`: tick of the state that is meant; None: the present decision. Raises NoAnswerError.
        """
        return await self._command(requests.AppraiseRequest, appraisal=appraisal, decision_tick=of)

    async def replace(self, rla: int, action: str) -> Answer:
        """Give one RLA, named by its id, another action. Raises NoAnswerError."""
        return await self._command(requests.ReplaceRequest, rla_id=rla, action=action)

    async def delete(self, rla: int) -> Answer:
        """Delete one RLA, named by its id. Raises NoAnswerError."""
        return await self._command(requests.DeleteRequest, rla_id=rla)

    async def name_situation(self, name: str, *, of: int | None = None) -> Answer:
        """Give the mid level's situation a name, so that it can be a goal.

        `of`: tick of the state that is meant; None: the present situation. Raises NoAnswerError.
        """
        return await self._command(requests.NameRequest, name=name, decision_tick=of)

    async def undo(self, lesson: str | None = None) -> Answer:
        """Undo a lesson by its command id, or all of a hold by its id; None: the last lesson or hold that stands.

        Raises NoAnswerError.
        """
        return await self._command(requests.UndoRequest, lesson=lesson)

    async def teach_shown(self, segments: Sequence[int] | None = None, *, press_id: int | None = None) -> Answer:
        """Teach the newest drive by hand, as `State.shown` cuts it into actions; undone as one.

        Args:
            segments: Indexes of the segments that are right. None: all.
            press_id: Press that the teacher saw, whose drive is taught. None: that of the newest state.

        Raises:
            ValueError: The newest state has no drive by hand to teach.
            NoAnswerError: The robot does not answer.
        """
        shown = None if self.state is None else self.state.shown
        if shown is None:
            raise ValueError("there is no drive by hand to teach; drive by hand and let go first")
        chosen = tuple(range(len(shown.actions)) if segments is None else segments)
        press_id = shown.press_id if press_id is None else press_id
        return await self._command(requests.ShownRequest, press_id=press_id, segments=chosen)

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
        """True while an unanswered stop is being sent: until its answer, `resume`, `run` or a press."""
        return self._open.stops.pending

    async def resume(self) -> Answer:
        """Let the robot drive again after a stop (the page's GO). Raises NoAnswerError.

        The answer is a refusal if a stop came since the newest state.
        """
        self._open.stops.supersede()
        return await self._move("go", requests.ResumeRequest)

    async def run(self, action: str, seconds: float) -> Answer:
        """Run one action of the repertoire for `seconds` of robot time; the robot stands afterwards.

        Returns as soon as the action begins. Raises NoAnswerError.
        """
        self._open.stops.supersede()

        async def begin() -> Answer:
            ticks = await self._ticks(seconds)
            return await self._command(requests.BehaviourRequest, moves=True, action=action, ticks=ticks)

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
        return self._drive.press(left_m_s, right_m_s)

    def press_action(self, action: str) -> bool:
        """Begin to hold an action, or hold another one in the present press; return whether a press is on.

        The robot does the action and is taught it on the way, until `let_go`. Raises WireError for a name that cannot
        be sent.
        """
        return self._drive.hold(action)

    async def let_go(self) -> Answer | None:
        """End the press that is on, and return the robot's answer; None if no press is on.

        The press is over before this waits for the answer, and a later press is not ended. After a held action the
        robot drives on by its RLAs, and the answer tells how many lessons it gave; after manual drive it stands. Raises
        NoAnswerError; the robot then ends the press by itself after its deadman time.
        """
        return await self._open.end_press(self._drive.press_id)

    @asynccontextmanager
    async def driving(self) -> AsyncIterator[ManualDriveHandle]:
        """Drive by hand inside the block; the press begins with the first speeds and ends with a stop.

        Raises NoAnswerError at the end of the block if the stop is not answered.
        """
        handle = ManualDriveHandle(self._drive)
        async with self._open.ending(handle):
            yield handle

    @asynccontextmanager
    async def hold(self, action: str) -> AsyncIterator[HoldHandle]:
        """Hold an action inside the block: the robot does it, and is taught it in the situations on the way.

        At the end of the block the robot drives on by its RLAs at once. Each 0.1 s becomes a lesson, unless the robot
        would do that action there by itself; the lessons are undone together. Afterwards the handle tells how many.
        Raises NoAnswerError at the end of the block, and WireError for a name that cannot be sent.
        """
        handle = HoldHandle(self._drive)
        handle.set(action)
        async with self._open.ending(handle):
            yield handle

    async def hold_for(self, action: str, seconds: float) -> Answer:
        """Hold an action for a time: the robot does it, is taught it on the way, and then drives on by its RLAs.

        Returns:
            Answer to the release, with the number of lessons; the refusal of a hold that ended before its time.

        Raises:
            NoAnswerError: The release is not answered.
            WireError: The name cannot be sent.
        """
        async with self.hold(action) as handle:
            await handle.wait(seconds)
        ended = handle.released or handle.ended or self._drive.refusal
        assert ended is not None, "a hold that is not released was refused"
        return ended

    # Goals

    async def pursue(self, behaviour: str) -> Answer:
        """Select which of the task's behaviours the robot follows and is taught. Raises NoAnswerError."""
        return await self._move(behaviour, requests.PursueRequest, behaviour=behaviour)

    async def seek(self, name: str) -> Answer:
        """Go to a named situation; the robot plans the way. Raises NoAnswerError.

        Without a way it stands and says so in its state.
        """
        return await self._move(name, requests.SeekRequest, name=name)

    async def seek_rla(self, rla: int) -> Answer:
        """Go to the situation that an RLA of the mid level knows; `rla` is its id. Raises NoAnswerError."""
        return await self._move(f"RLA {rla}", requests.SeekRlaRequest, rla_id=rla)

    async def seek_like(self, features: Mapping[str, float], tolerance: float) -> Answer:
        """Go to any situation with these feature values of the mid level.

        Args:
            features: Values by the name of the feature, in its unit.
            tolerance: Largest difference of each value, in the feature's unit (m, rad, counts or 0 to 1).

        Raises:
            NoAnswerError: The robot does not answer.
        """
        return await self._move(
            "a goal", requests.SeekLikeRequest, features=tuple(features.items()), tolerance=tolerance
        )

    async def stop_seeking(self) -> Answer:
        """Drop the goal; the mid level commands by its nearest RLA again. Raises NoAnswerError."""
        return await self._move("no goal", requests.SeekRequest, name=None)

    async def set_location(self, name: str) -> Answer:
        """Tell the robot that it was put down at a named situation. Raises NoAnswerError."""
        return await self._command(requests.SetLocationRequest, name=name)

    # Session

    async def begin_session(self, name: str) -> Answer:
        """Begin a session: the teaching clock runs. Raises NoAnswerError."""
        return await self._command(requests.SessionRequest, name=name)

    async def end_session(self) -> Answer:
        """End the session: the teaching clock stops. Raises NoAnswerError."""
        return await self._command(requests.SessionRequest, name=None)

    async def take(self) -> Answer:
        """Become the robot's teacher. On return the robot knows that its teacher is there.

        Raises NoAnswerError.
        """
        answer = await self._move("take", requests.TakeRequest)
        if answer.accepted:
            with anyio.move_on_after(_SEEN_IN_CHARGE_WITHIN_S):
                async for state in self.states():
                    if state.teacher == self.name:
                        self._drive.beat()
                        break
        return answer

    async def hand_over(self, to: str | None = None) -> Answer:
        """Stop being the teacher; `to` names the next one, None: the first one that takes the robot.

        Raises NoAnswerError.
        """
        return await self._command(requests.HandOverRequest, to=to)

    async def set_phase(self, phase: Phase) -> Answer:
        """Choose the training phase. Phase 5 drives without a teacher, so a stop ends that command.

        Raises NoAnswerError.
        """
        if phase is Phase.AUTONOMOUS:
            return await self._move("phase 5", requests.PhaseRequest, phase=phase)
        return await self._command(requests.PhaseRequest, phase=phase)

    async def set_lesson_speed(self, percent: int) -> Answer:
        """Set the speed of lessons (slow lessons): until the robot's program ends, or another speed is set.

        In phases 1 and 2 actions drive at so many per cent of their speed, 20 to 100, and their knowledge drives at
        full speed afterwards. Raises NoAnswerError.
        """
        return await self._command(requests.LessonSpeedRequest, percent=percent)

    async def save(self, label: str = "") -> Answer:
        """Copy the knowledge on the robot; `extra` of the answer holds the copy's `name` and `sha256`.

        `label` becomes part of the name. Raises NoAnswerError.
        """
        return await self._command(requests.SaveRequest, label=label)

    async def export(self, form: str = requests.TABLE) -> Answer:
        """Write the RLAs as a table on the robot, or with PACKAGE one file to give away.

        `extra` of the answer holds the file's `name` and `sha256`. Raises NoAnswerError.
        """
        return await self._command(requests.ExportRequest, form=form)

    async def examine(self) -> Answer:
        """Begin an exam of a copy of the present knowledge, of a simulated robot only; `exam` tells its status.

        Raises NoAnswerError.
        """
        return await self._command(requests.ExamRequest)

    # Simulation

    async def move_wall(self, name: str, dx_m: float, dy_m: float) -> Answer:
        """Shift a named wall or obstacle of the simulated world by (dx_m, dy_m), in m. Raises NoAnswerError."""
        return await self._command(requests.MoveWallRequest, name=name, dx_m=dx_m, dy_m=dy_m)

    async def place(self, x_m: float, y_m: float, heading_rad: float) -> Answer:
        """Put the simulated robot, standing, at a pose in m and rad. Raises NoAnswerError."""
        return await self._command(requests.PlaceRequest, x_m=x_m, y_m=y_m, heading_rad=heading_rad)

    async def put_back(self) -> Answer:
        """Put the simulated robot, standing, at the start of its run. Raises NoAnswerError."""
        return await self._command(requests.BackToStartRequest)

    async def next_run(self, world: str | None = None, task: str | None = None, *, fresh: bool = False) -> Answer:
        """End the present run and begin the next one, in which the robot stands until `resume`.

        Args:
            world: World by name. None: the present one.
            task: Task by name. None: the present one.
            fresh: Begin with an empty knowledge file; the present file is kept under another name.

        Raises:
            NoAnswerError: The robot does not answer.
        """
        return await self._command(requests.NextRunRequest, world=world, task=task, fresh=fresh)

    async def set_speed(self, times: int) -> Answer:
        """Set the speed of a simulated robot's time, 1 to 10 times real time; a slow machine reaches less.

        Raises NoAnswerError.
        """
        return await self._command(requests.SpeedRequest, times=times)

    async def load(self, content: bytes) -> Answer:
        """Upload knowledge at up to 100 kB/s and begin the next run with it.

        `content` is an archive of `export` or a knowledge file. Raises NoAnswerError.
        """
        upload = secrets.token_bytes(UPLOAD_ID_BYTES)
        try:
            await self.upload(upload, content)
        except RefusedError as error:
            return error.answer or Answer(False, "refused", str(error), -1)
        return await self.load_upload(upload, hashlib.sha256(content).digest())

    async def upload(self, upload: bytes, content: bytes) -> None:
        """Upload a file into the robot's memory under the random id `upload`, for `load_upload`.

        Raises RefusedError if the robot refuses a part, NoAnswerError.
        """
        sender = self._open.sender
        state = await sender.state()
        for offset in range(0, len(content), UPLOAD_PART_BYTES):
            part = content[offset : offset + UPLOAD_PART_BYTES]
            began_s = self._now()
            answer = await sender.send(requests.UploadRequest(state.boot, upload, offset, part))
            if not answer.accepted:
                raise RefusedError(answer.text or answer.why, answer)
            # The robot drops more than 200 requests a second of one key.
            await anyio.sleep(max(0.0, _PART_EACH_S - (self._now() - began_s)))

    async def load_upload(self, upload: bytes, sha256: bytes) -> Answer:
        """Begin the next run with an uploaded file; `sha256` is the hash of its content. Raises NoAnswerError."""
        return await self._command(requests.LoadRequest, upload=upload, sha256=sha256)

    # Sending

    async def _command(self, kind: Callable[..., Request], *, moves: bool = False, **fields: Any) -> Answer:
        return await self._open.sender.command(kind, moves=moves, **fields)

    async def _move(self, label: str, kind: Callable[..., Request], /, **fields: Any) -> Answer:
        """Send a command that may set the robot in motion; a stop before its answer ends it."""
        return await self._open.stops.move(label, lambda: self._command(kind, moves=True, **fields))
