"""Client of a robot that answers as the test says and notes its calls."""

import math
from collections.abc import AsyncIterator
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any

import anyio
import anyio.lowlevel

from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.hello import Hello, SensorPlace
from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.limits import VERSION
from kurt2rt.channel.protocol.requests import CommandRequest
from kurt2rt.channel.protocol.simulation import NO_EXAM, ExamStatus, SimulationView, TaskName, WorldView
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.standing import Standing
from kurt2rt.core.message_fields import checks_of
from kurt2rt.core.perception.sensor_words import infrared_law
from kurt2rt.core.teaching.commands import Single
from kurt2rt.platform.file_part import FilePart
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.teacher.client.answer import Answer, NoAnswerError, RefusedError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.client.link_quality import LinkQuality
from simbridge.contracts.simulation import SimulatedPlace
from tests.channel.states import standing_in, state

_COUNTS = (180, 176, 178, 175, 75, 74, 76, 78, 120, 90, 105, 70, 71, 72, 210, 82, 160, 70)
_FORWARD = {"cause": "rla", "action": "forward", "rla": 1, "nearest": 1, "distance": 300.0, "radius": 700.0}
_BEGUN = {"rlas": 1, "lessons": 1, "question": (), "teacher": None, "session": None, "clock_s": 0.0, "place": None}
A_STATE = state(tick=100, phase=1, infrared_counts=_COUNTS, left_m_s=0.3, right_m_s=0.3, **_FORWARD, **_BEGUN)
A_PLACE = SimulatedPlace(x_m=0.54, y_m=3.63, heading_rad=0.0, laps=0.0, collisions=0, world_version=0)


A_HELLO = Hello(
    version=VERSION,
    boot=b"boot",
    tick=100,
    robot="kurt2-indoor",
    task="wall_following",
    radius=700.0,
    period_s=0.01,
    actions=("forward", "spin_left", "spin_right"),
    sensors=tuple(
        SensorPlace(each.name, each.label, each.x_m, each.y_m, each.heading_deg)
        for each in load_robot().infrared.sensors
    ),
    outline=(0.434, 0.33),
    max_m_s=0.6,
    simulated=True,
    phases=("supervised", "corrections", "reinforcement", "critic", "autonomous"),
    what="",
    law=infrared_law(load_robot().infrared),
    track_m=0.406,
)
A_WORLD = WorldView(0, "A", (3.0, 4.0), ((0.0, 0.0), (3.0, 0.0), (3.0, 4.0), (0.0, 4.0)), (), ())
A_SIMULATION = SimulationView(
    "a",
    "wall_following",
    ("a", "b", "c", "manhattan", "rooms-N"),
    (TaskName("eight", "Teach it to drive an eight round the two columns"), TaskName("wall_following", "Teach it so")),
)
A_LINK = LinkQuality(4.0, 1.0, 20.0)
A_LESSON = LessonLine("phone-0a", "RLA 1: forward", "phone", 1, 90, "2026-11-21T12:04:00Z", False)


@dataclass
class FakeRobot(TeacherClient):
    """TeacherClient without a network: each call is noted in `told`."""

    told: list[tuple[Any, ...]] = field(default_factory=list)
    silent: bool = False
    refuses: str = ""
    watching: bool = False
    pressing: bool = False
    refusal: Answer | None = None
    trouble: str = ""
    state_age_s: float = math.inf
    state: State | None = None
    standing: Standing | None = None
    greeting: Hello = A_HELLO
    named: tuple[str, ...] = ()
    simulated: SimulationView = A_SIMULATION
    examined: ExamStatus = NO_EXAM
    files: dict[str, bytes] = field(default_factory=dict)
    answers_with: dict[str, object] = field(default_factory=dict)
    """Extra fields of its answers."""
    report: HealthReport | None = None
    decided: DecisionFacts | None = None
    newest_lessons: tuple[LessonLine, ...] = (A_LESSON,)
    link: LinkQuality = A_LINK
    _news: anyio.Event = field(default_factory=anyio.Event, init=False)

    def show(self, **changes: Any) -> State:
        """Send a new state, changed from the last one, two ticks later by default.

        Its standing is the one that was given last, and follows from the other fields if none was.
        """
        last = self.state or A_STATE
        self.standing = changes.pop("standing", self.standing)
        self.state = replace(last, **{"tick": last.tick + 2, **changes})
        self.state = replace(self.state, standing=self.standing or standing_in(self.state))
        self.state_age_s = 0.0
        self._news.set()
        self._news = anyio.Event()
        return self.state

    def reset(self) -> None:
        """Forget all calls and states."""
        for each in fields(self):
            if each.init:
                new = each.default if each.default_factory is MISSING else each.default_factory()
                setattr(self, each.name, new)

    def told_of(self, name: str) -> list[tuple[Any, ...]]:
        """Return its calls of one name."""
        return [each for each in self.told if each[0] == name]

    async def states(self) -> AsyncIterator[State]:
        seen = None
        while True:
            if self.state is None or self.state is seen:
                await self._news.wait()
                continue
            seen = self.state
            yield seen

    def press(self, left_m_s: float, right_m_s: float) -> bool:
        self.told.append(("press", left_m_s, right_m_s))
        self.pressing = True
        return True

    def press_action(self, action: str) -> bool:
        self.told.append(("hold", action))
        self.pressing = True
        return True

    async def let_go(self) -> Answer | None:
        self.pressing = False
        return await self._answer("let_go")

    async def hello(self) -> Hello:
        await self._answer("hello")
        return self.greeting

    async def lessons(self, count: int = 10) -> tuple[LessonLine, ...]:
        await self._answer("lessons", count)
        return self.newest_lessons

    async def health(self) -> HealthReport | None:
        await self._reach()
        return self.report

    async def why(self) -> DecisionFacts | None:
        await self._answer("why")
        return self.decided

    async def world(self) -> WorldView | None:
        await self._answer("world")
        return A_WORLD

    async def send(self, kind: type[Single | CommandRequest], /, **fields: Any) -> Answer:
        return await self._answer(kind.path, *(fields[name] for name in checks_of(kind) if name in fields))

    async def situations(self) -> tuple[str, ...]:
        await self._answer("situations")
        return self.named

    async def stop(self) -> Answer:
        self.pressing = False
        return await self._answer("stop")

    async def exam(self) -> ExamStatus | None:
        await self._reach()
        return self.examined

    async def file_parts(self, name: str) -> AsyncIterator[FilePart]:
        await self._answer("file_parts", name)
        if name not in self.files:
            raise RefusedError(f"{name}: not a copy of this run of the program; save or export again")
        for offset in range(0, len(self.files[name]), 1000):
            yield FilePart(len(self.files[name]), self.files[name][offset : offset + 1000])

    async def simulation(self) -> SimulationView | None:
        await self._reach()
        return self.simulated

    async def upload(self, upload: bytes, content: bytes) -> None:
        answer = await self._answer("upload", upload, content)
        if not answer.accepted:
            raise RefusedError(answer.text)

    async def _answer(self, *told: Any) -> Answer:
        self.told.append(told)
        await self._reach()
        if self.refuses:
            return Answer(False, "refused", self.refuses, 0)
        return Answer(True, "", f"{told[0]} done", 0, self.answers_with)

    async def _reach(self) -> None:
        if self.silent:
            raise NoAnswerError("no answer: not known whether it counted; look at the lessons")
        await anyio.lowlevel.checkpoint()
