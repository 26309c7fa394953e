"""Sender of a scripted teacher's commands over the channel; it knows the robot's ids of the teacher's own lessons."""

from kurt2rt.core.message_fields import checks_of
from kurt2rt.core.rla.lesson_history import hold_id
from kurt2rt.core.rla.rla import SCRIPTED
from kurt2rt.core.teaching.commands import (
    Command,
    Correct,
    DeleteRla,
    HoldAction,
    Resume,
    Stop,
    Teach,
    Undo,
)
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient


class CommandSender:
    """Sender of a scripted teacher's commands to a running robot, each once, without a second try."""

    def __init__(self, robot: TeacherClient) -> None:
        self._robot = robot
        self._lessons: dict[str, str] = {}
        """Id of a lesson in the robot's knowledge, by the teacher's own id of the press."""

    async def send(self, command: Command, tick: int) -> int:
        """Send a command; return 1 if it is a lesson that was accepted, else 0; a hold counts as one.

        An undo of a press that taught nothing, or whose answer was lost, is not sent.

        Args:
            command: of a scripted teacher of the basic level.
            tick: of the state that a lesson without a tick of its own is about.

        Raises:
            AssertionError: no scripted teacher of the basic level gives such a command.
        """
        robot = self._robot
        try:
            match command:
                case HoldAction(action=action):
                    robot.press_action(action)
                case Stop(press_id=None):
                    await robot.stop()
                case Resume():
                    await robot.send(Resume)
                case Undo(lesson=own_id):
                    lesson = self._lessons.pop(own_id or "", None)
                    if lesson is not None:
                        await robot.send(Undo, lesson=lesson)
                case Stop(press_id=int(press_id)):
                    return self._note(hold_id(SCRIPTED, press_id), await robot.let_go())
                case Teach() | Correct() | DeleteRla():
                    return self._note(command.command_id, await self._teach(command, tick))
                case _:
                    raise AssertionError(f"no command of a scripted teacher: {command}")
        except NoAnswerError:
            return 0
        return 0

    async def _teach(self, command: Teach | Correct | DeleteRla, tick: int) -> Answer:
        fields = {name: getattr(command, name) for name in checks_of(type(command))}
        if fields.get("decision_tick", tick) is None and not fields.get("late"):
            fields["decision_tick"] = tick
        return await self._robot.send(type(command), **fields)

    def _note(self, own_id: str, answer: Answer | None) -> int:
        """Note the lesson of a press; return 1 if the robot accepted the press, else 0."""
        if answer is None or not answer.accepted:
            return 0
        if answer.lesson is not None:
            self._lessons[own_id] = answer.lesson
        return 1
