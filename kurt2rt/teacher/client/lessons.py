"""What a teacher's device tells the robot of what is right: answers, corrections, signals, and lessons taken back.

`of` is the tick of the picture that is meant; None: the present decision.
"""

from kurt2rt.channel.protocol.lesson_list import LessonLine, lesson_lines_of
from kurt2rt.channel.protocol.requests import (
    AnswerRequest,
    AppraiseRequest,
    CorrectRequest,
    DeleteRequest,
    LessonsRequest,
    NameRequest,
    ReplaceRequest,
    RewardRequest,
    UndoRequest,
)
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.base import ClientBase
from kurt2rt.teacher.client.request_sender import facts_of


class LessonsMixin(ClientBase):
    """The lessons of a `TeacherClient`. Each raises NoAnswerError when nobody answers."""

    async def lessons(self, count: int = 10) -> tuple[LessonLine, ...]:
        """The newest lessons, up to 20, newest first."""
        return await self._asking.told(LessonsRequest(count), lambda response: lesson_lines_of(facts_of(response)))

    async def answer(self, action: str, *, of: int | None = None, level: str = BASIC, beside: bool = False) -> Answer:
        """Answer a situation: a new RLA (phase 1). At level MID `action` is a taught behaviour.

        `beside`: possible there, too, beside what the mid level knows already.
        """
        return await self._asking.command(AnswerRequest, action=action, decision_tick=of, level=level, beside=beside)

    async def correct(self, action: str, *, of: int | None = None, level: str = BASIC) -> Answer:
        """Another action is right (phase 2), at level MID another behaviour."""
        return await self._asking.command(CorrectRequest, action=action, decision_tick=of, level=level)

    async def reward(self, value: int, *, of: int | None = None) -> Answer:
        """Praise (+1) or blame (-1) what the robot did (phase 3)."""
        return await self._asking.command(RewardRequest, value=value, decision_tick=of)

    async def appraise(self, appraisal: str, *, of: int | None = None) -> Answer:
        """Teach the critic what a situation was worth: a name of `Hello.appraisals` (phase 4)."""
        return await self._asking.command(AppraiseRequest, appraisal=appraisal, decision_tick=of)

    async def replace(self, rla: int, action: str) -> Answer:
        """Give one RLA another action."""
        return await self._asking.command(ReplaceRequest, rla_id=rla, action=action)

    async def delete(self, rla: int) -> Answer:
        """Delete one RLA."""
        return await self._asking.command(DeleteRequest, rla_id=rla)

    async def name_situation(self, name: str, *, of: int | None = None) -> Answer:
        """Give the mid level's situation a name, so that it can be a goal."""
        return await self._asking.command(NameRequest, name=name, decision_tick=of)

    async def undo(self, lesson: str | None = None) -> Answer:
        """Take a lesson back by its command id; None: the last one that still stands."""
        return await self._asking.command(UndoRequest, lesson=lesson)
