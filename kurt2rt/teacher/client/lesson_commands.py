"""Commands of a teacher's device that teach."""

from collections.abc import Sequence

from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import (
    Appraise,
    Correct,
    DeleteRla,
    NameSituation,
    ReplaceAction,
    Reward,
    Teach,
    TeachShown,
    Undo,
)
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.command_client import CommandClient

_REWIND_S = 10.0
"""Driving that a robot keeps for late lessons, in s (1000 ticks)."""


class LessonCommands(CommandClient):
    """Answers, corrections, rewards, appraisals, and changes of single RLAs and lessons."""

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
        return await self._command(Teach, action=action, decision_tick=of, level=level, alternative=alternative)

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
        return await self._command(Correct, action=action, decision_tick=of, level=level, late=late)

    async def correct_earlier(self, action: str, seconds: float) -> Answer:
        """Correct what the basic level did `seconds` before it last drove (rewind).

        A robot keeps its last 10 s of driving, however long it has stood since or between.

        Raises:
            ValueError: `seconds` is not between 0 and 10, or no state of a driving robot came yet.
            NoAnswerError: the robot does not answer.
        """
        if not 0.0 <= seconds <= _REWIND_S:
            raise ValueError(f"seconds: a robot keeps the last {_REWIND_S:g} s of driving (got {seconds:g})")
        stream = self._stream
        tick = None if stream.tick_before(0) is None else stream.tick_before(await self._ticks(seconds))
        if tick is None:
            raise ValueError("this device has not seen the robot drive; correct what it does from now on")
        return await self.correct(action, of=tick)

    async def reward(self, value: int, *, of: int | None = None) -> Answer:
        """Reward what the robot did (phase 3).

        `value`: -1 or +1. `of`: tick of the state that is meant; None: the present decision. Raises NoAnswerError.
        """
        return await self._command(Reward, value=value, decision_tick=of)

    async def appraise(self, appraisal: str, *, of: int | None = None) -> Answer:
        """Teach the critic the value of a situation (phase 4): a name of `Hello.appraisals`.

        `of`: tick of the state that is meant; None: the present decision. Raises NoAnswerError.
        """
        return await self._command(Appraise, appraisal=appraisal, decision_tick=of)

    async def replace(self, rla: int, action: str) -> Answer:
        """Give one RLA, named by its id, another action. Raises NoAnswerError."""
        return await self._command(ReplaceAction, rla_id=rla, action=action)

    async def delete(self, rla: int) -> Answer:
        """Delete one RLA, named by its id. Raises NoAnswerError."""
        return await self._command(DeleteRla, rla_id=rla)

    async def name_situation(self, name: str, *, of: int | None = None) -> Answer:
        """Give the mid level's situation a name, so that it can be a goal.

        `of`: tick of the state that is meant; None: the present situation. Raises NoAnswerError.
        """
        return await self._command(NameSituation, name=name, decision_tick=of)

    async def undo(self, lesson: str | None = None) -> Answer:
        """Undo a lesson by its command id, or all of a hold by its id; None: the last lesson or hold that stands.

        Raises NoAnswerError.
        """
        return await self._command(Undo, lesson=lesson)

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
        return await self._command(TeachShown, press_id=press_id, segments=chosen)
