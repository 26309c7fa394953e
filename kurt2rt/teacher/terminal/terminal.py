"""`kurt2rt teach --terminal`: a person teaches by typing, one line, one command."""

import asyncio
import math
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from typing import NamedTuple, TextIO

import anyio
from anyio.abc import TaskGroup
from anyio.streams.memory import MemoryObjectSendStream

from kurt2rt.channel.protocol.codec import WireError
from kurt2rt.channel.protocol.health_text import lines_of
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.outcome_text import Surface
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.terminal.mid_commands import mid_command
from kurt2rt.teacher.terminal.terminal_text import (
    build_question,
    expects_answer,
    format_critic_change,
    format_mid_command,
    format_mid_situation,
    format_opinion,
    format_state,
    format_surprise,
    format_trust,
    help_lines,
    is_notable,
    name_lines,
)

_STEP_S = 0.5
_LESSONS_SHOWN = 10
_LESSONS_LOOKED_AT = 20
_SAYS_AT_MOST_EVERY_S = 1.0
_ASK_AGAIN_S = 0.5
_LOOK_EVERY_S = 0.5
_SILENT_AFTER_S = 1.5
_MOST_DIGITS = 15

Say = Callable[[str], None]


class _Line(NamedTuple):
    """What was typed, and when, as the robot has it."""

    text: str
    state: State | None
    """Newest picture then: what the teacher judged."""
    stop: anyio.Event
    """Set when the last stop that was typed before is over, answered or not."""


class TerminalTeacher:
    """Reads lines and says them to the robot, one after the other; a stop does not wait for those before it. Tells what
    the robot does when that changes.
    """

    def __init__(self, robot: TeacherClient, lines: TextIO, say: Say, where: str) -> None:
        """`where` the robot is looked for, to tell the teacher."""
        self._robot = robot
        self._lines = lines
        self._say = say
        self._where = where
        self._hello: Hello | None = None
        self._tried = anyio.Event()
        self._met = False
        self._last_stop = anyio.Event()
        self._last_stop.set()

    async def teach(self) -> None:
        """Until the lines end or one of them is `quit`; then the robot stands. The robot may come and go meanwhile."""
        async with anyio.create_task_group() as tasks:
            typed, taken = anyio.create_memory_object_stream[_Line](math.inf)
            with typed, taken:
                tasks.start_soon(self._listen, typed, tasks)
                tasks.start_soon(self._accompany, tasks)
                tasks.start_soon(self._watch_the_link)
                async for line in taken:
                    await self._tried.wait()
                    if line.text.split() in (["quit"], ["exit"]):
                        break
                    await self._take_line(line)
                await self._tried.wait()
                if self._met and await self._anyhow(self._tell(self._robot.stop())):
                    await self._anyhow(self._tell(self._robot.hand_over()))
                tasks.cancel_scope.cancel()

    async def _listen(self, typed: MemoryObjectSendStream[_Line], tasks: TaskGroup) -> None:
        with typed:
            async for text in self._typed():
                if text.split() in ([], ["stop"]):
                    self._last_stop = anyio.Event()
                    tasks.start_soon(self._stop, self._last_stop)
                else:
                    typed.send_nowait(_Line(text, self._robot.state, self._last_stop))

    async def _stop(self, over: anyio.Event) -> None:
        await self._anyhow(self._tell(self._robot.stop()))
        over.set()

    async def _take_line(self, line: _Line) -> None:
        await line.stop.wait()  # go after a stop is said after it
        if line.stop is not self._last_stop and _moves(line.text):
            self._say(f"not done, you stopped the robot after you typed it: {line.text}")
        elif line.state is not None and self._robot.state is not None and line.state.boot != self._robot.state.boot:
            self._say(f"not done, the robot program was started anew after you typed it: {line.text}")
        elif not self._met:
            self._say(f"not done, there is no robot at {self._where} yet: {line.text}")
        else:
            await self._anyhow(self._obey(line))

    async def _accompany(self, tasks: TaskGroup) -> None:
        """Meet the robot when it comes, and again whenever it was started anew."""
        hello = self._hello = await self._meet()
        self._say(f"{hello.robot}, task {hello.task}; help shows what can be typed; Enter alone stops the robot")
        if hello.what:
            self._say(hello.what)
        self._say_all(name_lines(hello))
        await self._anyhow(self._tell(self._robot.take()))
        self._met = True
        self._tried.set()
        tasks.start_soon(self._watch)
        boot = hello.boot
        async for state in self._robot.states():
            if state.boot != boot:
                boot = state.boot
                self._say("the robot program was started anew")
                await self._anyhow(self._meet_again())

    @property
    def _words(self) -> SensorWords:
        return NO_WORDS if self._hello is None else self._hello.sensor_words

    async def _meet(self) -> Hello:
        told = ""
        while True:
            try:
                return await self._robot.hello()
            except NoAnswerError as error:
                why = str(error) if isinstance(error.__cause__, WireError) else self._robot.trouble
                sentence = f"no robot at {self._where} yet" + (f": {why}" if why else "")
                if sentence != told:
                    self._say(sentence)
                told = sentence
                self._tried.set()
                await anyio.sleep(_ASK_AGAIN_S)

    async def _meet_again(self) -> None:
        self._hello = await self._robot.hello()
        state = self._robot.state
        teacher = None if state is None else state.teacher
        if teacher is None:
            await self._tell(self._robot.take())
        elif teacher != self._robot.name:
            self._say(f"{teacher} teaches now; type take to teach yourself")

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

    async def _watch_the_link(self) -> None:
        silent = False
        while True:
            await anyio.sleep(_LOOK_EVERY_S)
            age_s = self._robot.state_age_s
            if self._robot.state is not None and silent != (age_s > _SILENT_AFTER_S):
                silent = not silent
                self._say("no picture of the robot comes any more" if silent else "the robot is seen again")

    async def _watch(self) -> None:
        told = ""
        quiet_until = 0.0
        asking = ""
        standing: tuple[bool, str] | None = None
        commanded: tuple[object, ...] | None = None
        surprised = -1
        async for state in self._robot.states():
            if state.mid is not None and self._hello is not None and self._hello.mid is not None:
                way = format_mid_command(state, self._hello.mid)
                # The distance may change while it goes on saying the same.
                command = (state.mid.behaviour, state.mid.rla, state.mid.overridden, state.goal)
                if way and command != commanded:
                    self._say(way)
                    commanded = command
            if state.surprise is not None and state.surprise.tick > surprised:
                if not is_notable(state.surprise):
                    surprised = state.surprise.tick
                elif anyio.current_time() >= quiet_until:
                    self._say(format_surprise(state.surprise))
                    surprised = state.surprise.tick
                    quiet_until = anyio.current_time() + _SAYS_AT_MOST_EVERY_S
            if state.phase >= Phase.CRITIC and (state.trusted, state.role) != standing:
                standing = state.trusted, state.role
                self._say(f"critic: {format_trust(state)}")
            if state.stands.asks and not state.stands.needs_resume:
                if state.stands.reason != asking:
                    self._say(str(build_question(state, self._words)))
                asking = state.stands.reason
                told = ""
                continue
            asking = ""
            sentence = format_state(state)
            if sentence != told and anyio.current_time() >= quiet_until:
                self._say(sentence)
                told = sentence
                quiet_until = anyio.current_time() + _SAYS_AT_MOST_EVERY_S

    async def _obey(self, line: _Line) -> None:
        robot, hello = self._robot, self._hello
        assert hello is not None, "no line is taken before the robot was met"
        judged = None if line.state is None else line.state.tick
        given = mid_command(robot, hello, line.text.split(), line.state)
        if given is not None:
            await self._tell(given)
            return
        match line.text.split():
            case ["go"] | ["resume"]:
                await self._tell(robot.resume())
            case ["step", action]:
                await self._tell(robot.run(action, seconds=_STEP_S))
            case ["step", action, seconds] if _is_number(seconds):
                await self._tell(robot.run(action, seconds=float(seconds)))
            case ["+"]:
                await self._tell(robot.reward(1, of=judged))
            case ["-"]:
                await self._tell(robot.reward(-1, of=judged))
            case ["undo", *lesson] if len(lesson) <= 1:
                await self._tell(robot.undo(lesson[0] if lesson else None))
            case ["lessons"]:
                for each in reversed(await robot.lessons(_LESSONS_SHOWN)):
                    self._say(f"{each.command_id}  {each.text}{', undone' if each.undone else ''}")
            case ["replace", rla_id, action] if _is_count(rla_id):
                await self._tell(robot.replace(int(rla_id), action))
            case ["delete", rla_id] if _is_count(rla_id):
                await self._tell(robot.delete(int(rla_id)))
            case ["phase", ("1" | "2" | "3" | "4" | "5") as number]:
                await self._tell(robot.set_phase(Phase(int(number))))
            case ["pursue", behaviour]:
                await self._tell(robot.pursue(behaviour))
            case ["begin", *name]:
                await self._tell(robot.begin_session(" ".join(name) or "session"))
            case ["end"]:
                await self._tell(robot.end_session())
            case ["save", *label]:
                await self._tell(robot.save(" ".join(label)))
            case ["export"]:
                await self._tell(robot.export())
            case ["health"]:
                self._say_all(lines_of(await robot.health()))
            case ["take"]:
                await self._tell(robot.take())
            case ["release"]:
                await self._tell(robot.hand_over())
            case ["way"] if hello.mid is not None and line.state is not None and line.state.mid is not None:
                self._say(format_mid_command(line.state, hello.mid) or str(build_question(line.state, self._words)))
                self._say(format_mid_situation(line.state.mid, hello.mid))
            case ["places"] if hello.seeks:
                self._say(f"named: {', '.join(await robot.situations()) or 'nothing yet'}")
            case [action] if action in hello.actions:
                await self._teach(action, line.state)
            case [appraisal] if any(appraisal == each.name for each in hello.appraisals):
                await self._tell(robot.appraise(appraisal, of=judged))
            case ["critic"] if hello.appraisals and line.state is not None:
                self._say(format_opinion(line.state, hello.appraisals))
                latest = await robot.lessons(_LESSONS_LOOKED_AT)
                self._say(format_critic_change(next((each for each in latest if each.teacher == CRITIC), None)))
            case _:
                self._say_all(help_lines(hello))

    def _say_all(self, lines: Iterable[str]) -> None:
        for line in lines:
            self._say(line)

    async def _teach(self, action: str, state: State | None) -> None:
        # The same word answers a question and corrects a robot that knows, or thinks that it knows.
        if state is None:
            await self._tell(self._robot.answer(action))
        elif expects_answer(state):
            await self._tell(self._robot.answer(action, of=state.tick))
        else:
            await self._tell(self._robot.correct(action, of=state.tick))

    async def _tell(self, answer: Awaitable[Answer]) -> None:
        got = await answer
        text = got.text_on(Surface.TERMINAL)
        self._say(text if got.accepted else f"refused: {text}")

    async def _anyhow(self, saying: Awaitable[None]) -> bool:
        """Say something to the robot, which may be gone; whether it answered."""
        try:
            await saying
        except NoAnswerError as error:
            self._say(str(error))
            return False
        return True


def _moves(text: str) -> bool:
    """Whether a line may set the robot in motion."""
    match text.split():
        case ["go" | "resume" | "step" | "take" | "pursue" | "seek", *_] | ["phase", "5"]:
            return True
    return False


def _is_count(text: str) -> bool:
    return text.isdecimal() and len(text) <= _MOST_DIGITS


def _is_number(text: str) -> bool:
    return text.replace(".", "", 1).isdecimal() and len(text) <= _MOST_DIGITS
