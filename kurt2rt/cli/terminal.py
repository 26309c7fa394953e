"""`kurt2rt teach --terminal`: a person teaches by typing, one line, one command."""

import asyncio
import threading
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import TextIO

import anyio

from kurt2rt.channel.state import State
from kurt2rt.layers.decision import Cause
from kurt2rt.rla.rla import Phase
from kurt2rt.teaching.answer import Answer, NoAnswerError
from kurt2rt.teaching.client import TeacherClient
from kurt2rt.teaching.question import FeatureDifference, Question

_STEP_S = 0.5
_LESSONS_SHOWN = 10
_SAYS_AT_MOST_EVERY_S = 1.0

Say = Callable[[str], None]

_HELP = """\
an action                answers the robot's question, or corrects what it does
(just Enter), stop       the robot stands until you type go
go                       the robot drives where it knows the way
step ACTION [SECONDS]    one action for half a second, or as long as you say; teaches nothing
+, -                     reward or punish what the robot does
undo [LESSON], lessons   take the last lesson back, or the one of that id; show the last ten
replace N ACTION, delete N     change or end RLA N
phase 1 to 5             supervised, corrections, reinforcement, critic, autonomous
begin [NAME], end        a session of teaching, with its clock
save [LABEL], export     a copy of the knowledge, or a table of it, on the robot
take, release            be the teacher, or let another one be it
help, quit"""


class TerminalTeacher:
    """Reads lines and says them to the robot; tells what the robot does when that changes."""

    def __init__(self, robot: TeacherClient, lines: TextIO, say: Say) -> None:
        self._robot = robot
        self._lines = lines
        self._say = say
        self._actions: tuple[str, ...] = ()

    async def teach(self) -> None:
        """Until the lines end or one of them is `quit`; then the robot stands. Raises NoAnswerError without a robot."""
        robot = self._robot
        hello = await robot.hello()
        self._actions = tuple(hello.actions)
        self._say(f"{hello.robot}, task {hello.task}; help shows what can be typed; Enter alone stops the robot")
        self._say(f"actions: {', '.join(self._actions)}")
        await self._tell(robot.take())
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(self._watch)
            async for line in self._typed():
                if line.split() in (["quit"], ["exit"]):
                    break
                await self._obey(line)
            await self._tell(robot.stop())
            await self._tell(robot.hand_over())
            tasks.cancel_scope.cancel()

    async def _typed(self) -> AsyncIterator[str]:
        typed: asyncio.Queue[str | None] = asyncio.Queue()
        loop = asyncio.get_running_loop()

        def read() -> None:
            try:
                for line in self._lines:
                    loop.call_soon_threadsafe(typed.put_nowait, line)
                loop.call_soon_threadsafe(typed.put_nowait, None)
            except RuntimeError:
                return  # the loop is closed: nobody teaches any more

        # Daemon: reading a terminal cannot be interrupted, and must not keep the process alive.
        threading.Thread(target=read, name="terminal", daemon=True).start()
        while (line := await typed.get()) is not None:
            yield line.strip().lower()

    async def _watch(self) -> None:
        told = ""
        quiet_until = 0.0
        asking = False
        async for state in self._robot.states():
            if state.cause == Cause.UNKNOWN:
                if not asking:
                    self._say(str(question_in(state)))
                asking = True
                told = ""
                continue
            asking = False
            sentence = sentence_of(state)
            if sentence != told and anyio.current_time() >= quiet_until:
                self._say(sentence)
                told = sentence
                quiet_until = anyio.current_time() + _SAYS_AT_MOST_EVERY_S

    async def _obey(self, line: str) -> None:
        robot = self._robot
        match line.split():
            case [] | ["stop"]:
                await self._tell(robot.stop())
            case ["go"] | ["resume"]:
                await self._tell(robot.resume())
            case ["step", action]:
                await self._tell(robot.run(action, seconds=_STEP_S))
            case ["step", action, seconds] if _is_number(seconds):
                await self._tell(robot.run(action, seconds=float(seconds)))
            case ["+"]:
                await self._tell(robot.reward(1))
            case ["-"]:
                await self._tell(robot.reward(-1))
            case ["undo", *lesson] if len(lesson) <= 1:
                await self._tell(robot.undo(lesson[0] if lesson else None))
            case ["lessons"]:
                for each in reversed(await robot.lessons(_LESSONS_SHOWN)):
                    self._say(f"{each.command_id}  {each.text}{', undone' if each.undone else ''}")
            case ["replace", rla_id, action] if rla_id.isdecimal():
                await self._tell(robot.replace(int(rla_id), action))
            case ["delete", rla_id] if rla_id.isdecimal():
                await self._tell(robot.delete(int(rla_id)))
            case ["phase", number] if number in "12345":
                await self._tell(robot.set_phase(Phase(int(number))))
            case ["begin", *name]:
                await self._tell(robot.begin_session(" ".join(name) or "session"))
            case ["end"]:
                await self._tell(robot.end_session())
            case ["save", *label]:
                await self._tell(robot.save(" ".join(label)))
            case ["export"]:
                await self._tell(robot.export())
            case ["take"]:
                await self._tell(robot.take())
            case ["release"]:
                await self._tell(robot.hand_over())
            case [action] if action in self._actions:
                await self._teach(action)
            case _:
                self._say(_HELP)
                self._say(f"actions: {', '.join(self._actions)}")

    async def _teach(self, action: str) -> None:
        state = self._robot.state
        # The same word answers a question and corrects a robot that knows, or thinks that it knows.
        if state is None or state.nearest is None or state.distance > state.radius:
            await self._tell(self._robot.answer(action))
        else:
            await self._tell(self._robot.correct(action, of=state.tick))

    async def _tell(self, answer: Awaitable[Answer]) -> None:
        try:
            got = await answer
        except NoAnswerError as error:
            self._say(str(error))
            return
        self._say(got.text if got.accepted else f"refused: {got.text}")


def question_in(state: State) -> Question:
    """The question that a picture shows."""
    differing = tuple(FeatureDifference(each.name, each.here, each.in_condition) for each in state.question)
    return Question(state.nearest, state.nearest_action, state.distance, state.radius, differing)


def sentence_of(state: State) -> str:
    """What the robot does and why, without what changes all the time."""
    if state.action is not None:
        if state.rla is None:
            return f"{state.action}, by {state.teacher}"
        return f"{state.action} by RLA {state.rla}"
    return f"stands: {state.stopped_because or state.cause}" + (f"; {state.trouble}" if state.trouble else "")


def _is_number(text: str) -> bool:
    return text.replace(".", "", 1).isdecimal()
