"""`kurt2rt teach --terminal`: teaching by typed lines, one command each."""

import asyncio
import math
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Sequence
from dataclasses import MISSING, fields
from typing import Any, NamedTuple, TextIO

import anyio
from anyio.abc import TaskGroup
from anyio.streams.memory import MemoryObjectSendStream

from kurt2rt.channel.protocol.health_text import lines_of
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.requests import CommandRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import ASKING
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.message_fields import Check, WireError, checks_of
from kurt2rt.core.outcome_text import Surface
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.rla.rla import CRITIC, MID, Phase
from kurt2rt.core.teaching.commands import (
    Appraise,
    BeginSession,
    Correct,
    HandOver,
    Reward,
    Seek,
    Single,
    StopSeeking,
    Take,
    Teach,
)
from kurt2rt.runs.explain.reasons import format_decision
from kurt2rt.teacher.client.answer import Answer, NoAnswer, NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.terminal.terminal_text import (
    KINDS,
    build_question,
    expects_answer,
    expects_mid_answer,
    format_critic_change,
    format_mid_command,
    format_mid_situation,
    format_misunderstood,
    format_opinion,
    format_state,
    format_surprise,
    format_trust,
    help_lines,
    is_notable,
    lesson_lines,
    name_lines,
)


def _lesson(robot: TeacherClient, hello: Hello, words: Sequence[str], state: State | None) -> Awaitable[Answer] | None:
    """Return the sending of a lesson of the mid level in a line of `words`; None if the line is none."""
    if hello.mid is None:
        return None
    tick = None if state is None else state.tick
    match words:
        case [behaviour] if _means_behaviour(behaviour, hello, state):
            if state is None or state.mid is None or expects_mid_answer(state.mid):
                return robot.send(Teach, action=behaviour, decision_tick=tick, level=MID)
            return robot.send(Correct, action=behaviour, decision_tick=tick, level=MID)
        case ["also", behaviour]:
            return robot.send(Teach, action=behaviour, decision_tick=tick, level=MID, alternative=True)
    return None


def _goal(robot: TeacherClient, hello: Hello, words: Sequence[str]) -> Awaitable[Answer] | None:
    match words if hello.seeks else ():
        case ["seek"]:
            return robot.send(StopSeeking)
        case ["seek", "rla", rla_id] if rla_id.isdecimal() and len(rla_id) <= _MOST_DIGITS:
            return robot.send(Seek, goal=RlaGoal(int(rla_id)))
        case ["seek", *goal]:
            return robot.send(Seek, goal=_features_in(goal) or NamedGoal(" ".join(goal)))
    return None


def _means_behaviour(name: str, hello: Hello, state: State | None) -> bool:
    """Return whether a name means the behaviour; an action of the same name goes first unless the mid level asks."""
    if name not in hello.behaviours:
        return False
    return name not in hello.actions or (state is not None and state.asks_at == MID)


def _features_in(words: Sequence[str]) -> PartialGoal | None:
    """Parse features and tolerance of a goal, such as x_m=1.8 wall_left=1 within 0.2; None for anything else."""
    tolerance = None
    if len(words) > 2 and words[-2] == "within":
        words, tolerance = words[:-2], _number_in(words[-1])
        if tolerance is None:
            return None
    features: dict[str, float] = {}
    for word in words:
        name, equals, value = word.partition("=")
        number = _number_in(value)
        if not name or not equals or number is None:
            return None
        features[name] = number
    return PartialGoal(tuple(features.items()), tolerance or 0.0) if features else None


def _number_in(text: str) -> float | None:
    plain = text.removeprefix("-").replace(".", "", 1)
    return float(text) if plain.isdecimal() and len(text) <= _MOST_DIGITS else None


_STEP_S = 0.5
_LESSONS_SHOWN = 10
_LESSONS_SEARCHED = 20
_REPORT_PERIOD_S = 1.0
_POLL_S = 0.5
_SILENT_AFTER_S = 1.5
_MOST_DIGITS = 15

Say = Callable[[str], None]


class _Line(NamedTuple):
    """Typed line, with the robot's state at that time."""

    text: str
    state: State | None
    """Newest state when it was typed, which the teacher judged."""
    stop: anyio.Event
    """Set when the last stop before this line was answered, or got no answer."""


class TerminalTeacher:
    """Teacher at a terminal: lines become commands in order, and changes of the robot's state become lines.

    A stop does not wait for the commands before it.
    """

    def __init__(self, robot: TeacherClient, lines: TextIO, say: Say, where: str) -> None:
        """Read `lines` and print by `say`; `where` is the robot's address, for texts."""
        self._robot = robot
        self._lines = lines
        self._say = say
        self._where = where
        self._hello: Hello | None = None
        self._met = anyio.Event()
        self._last_stop = anyio.Event()
        self._last_stop.set()

    async def teach(self) -> None:
        """Teach until the lines end or one of them is `quit`, then stop the robot. It may restart meanwhile.

        Raises NoAnswerError in a group if there is no robot.
        """
        async with anyio.create_task_group() as tasks:
            typed, taken = anyio.create_memory_object_stream[_Line](math.inf)
            with typed, taken:
                tasks.start_soon(self._listen, typed, tasks)
                tasks.start_soon(self._session, tasks)
                tasks.start_soon(self._poll_link)
                await self._met.wait()
                async for line in taken:
                    if line.text.split() in (["quit"], ["exit"]):
                        break
                    await self._on_line(line)
                if await self._attempt(self._send(self._robot.stop())):
                    await self._attempt(self._send(self._robot.send(HandOver)))
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
        await self._attempt(self._send(self._robot.stop()))
        over.set()

    async def _on_line(self, line: _Line) -> None:
        await line.stop.wait()  # a go that follows a stop is sent after it
        if line.stop is not self._last_stop and _moves(line.text):
            self._say(f"not done, you stopped the robot after you typed it: {line.text}")
        elif line.state is not None and self._robot.state is not None and line.state.boot != self._robot.state.boot:
            self._say(f"not done, the robot program was restarted after you typed it: {line.text}")
        else:
            await self._attempt(self._execute(line))

    async def _session(self, tasks: TaskGroup) -> None:
        """Introduce the robot when it is there, and again after each restart."""
        hello = self._hello = await self._connect()
        self._say(f"{hello.robot}, task {hello.task}; help shows what can be typed; Enter alone stops the robot")
        if hello.what:
            self._say(hello.what)
        self._say_all(name_lines(hello))
        await self._attempt(self._send(self._robot.send(Take)))
        self._met.set()
        tasks.start_soon(self._report_states)
        boot = hello.boot
        async for state in self._robot.states():
            if state.boot != boot:
                boot = state.boot
                self._say("the robot program was restarted")
                await self._attempt(self._reconnect())

    @property
    def _words(self) -> SensorWords:
        return NO_WORDS if self._hello is None else self._hello.sensor_words

    async def _connect(self) -> Hello:
        try:
            return await self._robot.hello()
        except NoAnswerError as error:
            if isinstance(error.__cause__, WireError):  # a robot of another version
                raise
            why = f" ({self._robot.trouble})" if self._robot.trouble else ""
            do = "start one in another terminal: kurt2rt run"
            raise NoAnswerError(f"at {self._where}{why}", NoAnswer.NO_ROBOT, do=do) from error

    async def _reconnect(self) -> None:
        self._hello = await self._robot.hello()
        state = self._robot.state
        teacher = None if state is None else state.teacher
        if teacher is None:
            await self._send(self._robot.send(Take))
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
                return  # the loop is closed: teaching is over

        # Daemon: reading a terminal cannot be interrupted, and must not keep the process alive.
        threading.Thread(target=read, name="terminal", daemon=True).start()
        while (line := await typed.get()) is not None:
            yield line.strip().lower()

    async def _poll_link(self) -> None:
        silent = False
        while True:
            await anyio.sleep(_POLL_S)
            age_s = self._robot.state_age_s
            if self._robot.state is not None and silent != (age_s > _SILENT_AFTER_S):
                silent = not silent
                self._say("the robot is silent" if silent else "the robot is back")

    async def _report_states(self) -> None:
        told = ""
        quiet_until = 0.0
        asking = ""
        standing: tuple[bool, str] | None = None
        commanded: tuple[object, ...] | None = None
        surprised = -1
        async for state in self._robot.states():
            if state.mid is not None and self._hello is not None and self._hello.mid is not None:
                way = format_mid_command(state, self._hello.mid)
                # Printed once for each choice: the distance changes all the time.
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
                    quiet_until = anyio.current_time() + _REPORT_PERIOD_S
            if state.phase >= Phase.CRITIC and (state.trusted, state.role) != standing:
                standing = state.trusted, state.role
                self._say(f"critic: {format_trust(state)}")
            if state.standing.asks and not state.standing.needs_resume:
                # Noise lets the robot drive for moments while its question is open; those states do not have its words.
                if state.standing.reason != asking and state.cause in ASKING:
                    self._say(str(build_question(state, self._words)))
                    asking = state.standing.reason
                told = ""
                continue
            asking = ""
            sentence = format_state(state)
            if sentence != told and anyio.current_time() >= quiet_until:
                self._say(sentence)
                told = sentence
                quiet_until = anyio.current_time() + _REPORT_PERIOD_S

    async def _execute(self, line: _Line) -> None:
        robot, hello, state = self._robot, self._hello, line.state
        assert hello is not None, "no line is executed before the robot was met"
        words = line.text.split()
        command = _lesson(robot, hello, words, state) or _goal(robot, hello, words)
        command = command or self._command(words, hello, state)
        if command is not None:
            await self._send(command)
            return
        match words:
            case ["lessons"]:
                for each in reversed(await robot.lessons(_LESSONS_SHOWN)):
                    self._say_all(lesson_lines(each))
            case ["why"]:
                facts = await robot.why()
                self._say("it has not decided yet" if facts is None else format_decision(facts))
            case ["health"]:
                self._say_all(lines_of(await robot.health()))
            case ["way"] if hello.mid is not None and state is not None and state.mid is not None:
                self._say(format_mid_command(state, hello.mid) or str(build_question(state, self._words)))
                self._say(format_mid_situation(state.mid, hello.mid))
            case ["places"] if hello.seeks:
                self._say(f"named: {', '.join(await robot.situations()) or 'nothing yet'}")
            case ["critic"] if hello.appraisals and state is not None:
                self._say(format_opinion(state, hello.appraisals))
                latest = await robot.lessons(_LESSONS_SEARCHED)
                self._say(format_critic_change(next((each for each in latest if each.teacher == CRITIC), None)))
            case ["help"]:
                self._say_all(help_lines(hello))
            case _:
                self._say(format_misunderstood(words, hello))

    def _command(self, words: Sequence[str], hello: Hello, state: State | None) -> Awaitable[Answer] | None:
        """Return the command of a line, if it is one; `state` is the newest one when it was typed."""
        robot, tick = self._robot, None if state is None else state.tick
        match words:
            case ["step", action]:
                return robot.run(action, seconds=_STEP_S)
            case ["step", action, seconds] if _is_number(seconds):
                return robot.run(action, seconds=float(seconds))
            case [("+" | "-") as sign]:
                return robot.send(Reward, value=1 if sign == "+" else -1, decision_tick=tick)
            case ["begin"]:
                return robot.send(BeginSession, name="session")
            case [action] if action in hello.actions:
                # The same word answers a question and corrects a robot that drives.
                if expects_answer(state):
                    return robot.send(Teach, action=action, decision_tick=tick)
                return robot.send(Correct, action=action, decision_tick=tick, late=True)
            case ["hold", action, seconds] if action in hello.actions and _is_number(seconds):
                return robot.hold_for(action, float(seconds))
            case ["rewind", seconds, action] if action in hello.actions and _is_number(seconds):
                return robot.correct_earlier(action, float(seconds))
            case [appraisal] if any(appraisal == each.name for each in hello.appraisals):
                return robot.send(Appraise, appraisal=appraisal, decision_tick=tick)
            case [word, *values] if word in KINDS:
                fields = _fields_in(KINDS[word], values, tick)
                return None if fields is None else robot.send(KINDS[word], **fields)
        return None

    def _say_all(self, lines: Iterable[str]) -> None:
        for line in lines:
            self._say(line)

    async def _send(self, answer: Awaitable[Answer]) -> None:
        try:
            got = await answer
        except ValueError as error:
            self._say(f"refused: {error}")
            return
        text = got.text_on(Surface.TERMINAL)
        self._say(text if got.accepted else f"refused: {text}")

    async def _attempt(self, request: Awaitable[None]) -> bool:
        """Await a request; print the error of a robot that does not answer, and return whether it did."""
        try:
            await request
        except NoAnswerError as error:
            self._say(str(error))
            return False
        return True


def _moves(text: str) -> bool:
    """Return whether a line may set the robot in motion."""
    word = text.split()[0]
    return word in ("step", "hold") or (word in KINDS and KINDS[word].moves)


def _fields_in(kind: type[Single | CommandRequest], values: Sequence[str], tick: int | None) -> dict[str, Any] | None:
    """Return the fields of a typed command, the last one with all words that are left; None if one is missing.

    `tick`: of the state that the teacher judged. A wrong value is refused by the client.
    """
    own = checks_of(CommandRequest)
    checks = {name: check for name, check in checks_of(kind).items() if name not in (*own, "decision_tick")}
    needed = sum(each.default is MISSING for each in fields(kind) if each.name in checks)
    if not needed <= len(values) or (values and not checks):
        return None
    places = [*values[: len(checks) - 1], " ".join(values[len(checks) - 1 :])] if len(values) > len(checks) else values
    typed = {name: _value(check, word) for (name, check), word in zip(checks.items(), places, strict=False)}
    return {**typed, "decision_tick": tick} if hasattr(kind, "decision_tick") else typed


def _value(check: Check, word: str) -> object:
    try:
        return check("", word)
    except WireError:
        return int(word) if word.isdecimal() and len(word) <= _MOST_DIGITS else word


def _is_number(text: str) -> bool:
    return text.replace(".", "", 1).isdecimal() and len(text) <= _MOST_DIGITS
