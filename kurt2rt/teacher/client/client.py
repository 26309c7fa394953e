"""Teacher's device in Python: see the robot, teach it and drive it over the network.

async with TeacherClient(Path("var/devices/phone")) as robot:
    await robot.take()
    async for state in robot.states():
        if state.cause == "unknown":
            await robot.answer("forward", of=state.tick)
"""

from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

import anyio

from kurt2rt.channel.protocol.requests import TABLE, ExamRequest, ExportRequest, SaveRequest
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import (
    BeAt,
    BeginSession,
    EndSession,
    HandOver,
    Pursue,
    Resume,
    RunBehaviour,
    Seek,
    SetLessonSpeed,
    SetPhase,
    StopSeeking,
    Take,
)
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.lesson_commands import LessonCommands
from kurt2rt.teacher.client.manual_drive import HoldHandle, ManualDriveHandle
from kurt2rt.teacher.client.simulation_commands import SimulationCommands

_SEEN_IN_CHARGE_WITHIN_S = 1.0


class TeacherClient(LessonCommands, SimulationCommands):
    """Async context manager that connects a teacher's device to one robot.

    Inside it states come in. While this device is in charge, it reports its teacher's presence to the robot.

    Commands are sent again every 0.1 s, count once, and return the robot's `Answer`; a refusal is an Answer too. They
    raise NoAnswerError after 3.5 s without an answer; it is then unknown whether they counted. `stop` overtakes every
    other command. Lessons take the tick of the state that is meant as `of`; None: the present decision. Only one
    program at a time can use a pairing.
    """

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
        return await self._move("go", Resume)

    async def run(self, action: str, seconds: float) -> Answer:
        """Run one action of the repertoire for `seconds` of robot time; the robot stands afterwards.

        Returns as soon as the action begins. Raises NoAnswerError.
        """
        self._open.stops.supersede()

        async def begin() -> Answer:
            ticks = await self._ticks(seconds)
            return await self._command(RunBehaviour, moves=True, action=action, ticks=ticks)

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
        return await self._move(behaviour, Pursue, behaviour=behaviour)

    async def seek(self, name: str) -> Answer:
        """Go to a named situation; the robot plans the way. Raises NoAnswerError.

        Without a way it stands; its state shows that.
        """
        return await self._move(name, Seek, goal=NamedGoal(name))

    async def seek_rla(self, rla: int) -> Answer:
        """Go to the situation that an RLA of the mid level knows; `rla` is its id. Raises NoAnswerError."""
        return await self._move(f"RLA {rla}", Seek, goal=RlaGoal(rla))

    async def seek_like(self, features: Mapping[str, float], tolerance: float) -> Answer:
        """Go to any situation with these feature values of the mid level.

        Args:
            features: Values by the name of the feature, in its unit.
            tolerance: Largest difference of each value, in the feature's unit (m, rad, counts or 0 to 1).

        Raises:
            NoAnswerError: The robot does not answer.
        """
        return await self._move("a goal", Seek, goal=PartialGoal(tuple(features.items()), tolerance))

    async def stop_seeking(self) -> Answer:
        """Drop the goal; the mid level commands by its nearest RLA again. Raises NoAnswerError."""
        return await self._move("no goal", StopSeeking)

    async def set_location(self, name: str) -> Answer:
        """Tell the robot that it was put down at a named situation. Raises NoAnswerError."""
        return await self._command(BeAt, name=name)

    # Session

    async def begin_session(self, name: str) -> Answer:
        """Begin a session: the teaching clock runs. Raises NoAnswerError."""
        return await self._command(BeginSession, name=name)

    async def end_session(self) -> Answer:
        """End the session: the teaching clock stops. Raises NoAnswerError."""
        return await self._command(EndSession)

    async def take(self) -> Answer:
        """Become the robot's teacher. On return the robot knows that its teacher is there.

        Raises NoAnswerError.
        """
        answer = await self._move("take", Take)
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
        return await self._command(HandOver, to=to)

    async def set_phase(self, phase: Phase) -> Answer:
        """Choose the training phase. Phase 5 drives without a teacher, so a stop ends that command.

        Raises NoAnswerError.
        """
        if phase is Phase.AUTONOMOUS:
            return await self._move("phase 5", SetPhase, phase=phase)
        return await self._command(SetPhase, phase=phase)

    async def set_lesson_speed(self, percent: int) -> Answer:
        """Set the speed of lessons (slow lessons): until the robot's program ends, or another speed is set.

        In phases 1 and 2 actions drive at `percent` of their speed, 20 to 100, and their knowledge drives at
        full speed afterwards. Raises NoAnswerError.
        """
        return await self._command(SetLessonSpeed, percent=percent)

    async def save(self, label: str = "") -> Answer:
        """Copy the knowledge on the robot; `extra` of the answer holds the copy's `name` and `sha256`.

        `label` becomes part of the name. Raises NoAnswerError.
        """
        return await self._command(SaveRequest, label=label)

    async def export(self, form: str = TABLE) -> Answer:
        """Write the RLAs as a table on the robot, or with PACKAGE one file to give away.

        `extra` of the answer holds the file's `name` and `sha256`. Raises NoAnswerError.
        """
        return await self._command(ExportRequest, form=form)

    async def examine(self) -> Answer:
        """Begin an exam of a copy of the present knowledge, of a simulated robot only; `exam` tells its status.

        Raises NoAnswerError.
        """
        return await self._command(ExamRequest)
