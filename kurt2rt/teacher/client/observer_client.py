"""Client that looks at a robot over the network and commands nothing.

async with ObserverClient(Path("var/devices/local")) as robot:
    robot.watching = False
    report = await robot.health()
"""

import time
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Self

from kurt2rt.channel.protocol import requests
from kurt2rt.channel.protocol.codec import FACTS
from kurt2rt.channel.protocol.health import HEALTH, HealthReport
from kurt2rt.channel.protocol.hello import Hello, hello_of
from kurt2rt.channel.protocol.lesson_list import LESSONS, SITUATIONS, LessonLine
from kurt2rt.channel.protocol.simulation import EXAM, SIMULATION, WORLD, ExamStatus, SimulationView, WorldView
from kurt2rt.channel.protocol.state import State
from kurt2rt.platform.file_part import FilePart
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.teacher.client.connection import Connection, open_connection
from kurt2rt.teacher.client.link_quality import LinkQuality
from kurt2rt.teacher.client.manual_drive import ManualDrive
from kurt2rt.teacher.client.state_stream import StateStream

ANSWER_WITHIN_S = 3.5


class ObserverClient:
    """Async context manager that connects a device to one robot, whose states come in inside it.

    Queries change nothing on the robot. They raise NoAnswerError after 3.5 s without an answer. Only one program at a
    time can use a pairing.
    """

    def __init__(
        self,
        folder: Path,
        host: str | None = None,
        port: int | None = None,
        *,
        patience_s: float = ANSWER_WITHIN_S,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Name the robot; nothing is sent before the context is entered.

        Args:
            folder: Device's side of a pairing.
            host: Address of the robot. None: as noted in the pairing.
            port: UDP port of the robot. None: as noted in the pairing.
            patience_s: Seconds to wait for the answer to a request.
            now: Monotonic clock in seconds.
        """
        self.name = folder.name
        """Name of this device, and so of the teacher."""
        self._folder = folder
        self._host = host
        self._port = port
        self._patience_s = patience_s
        self._now = now
        self._stream = StateStream(now)
        self._period_s: float | None = None
        self._connection: Connection | None = None
        self._stack = AsyncExitStack()

    async def __aenter__(self) -> Self:
        """Open the pairing and subscribe to the states. The robot need not be there yet. Raises CredentialsError."""
        connection = await self._stack.enter_async_context(
            open_connection(self._folder, self._host, self._port, self._stream, self._patience_s, self._now)
        )
        self._connection, self.name = connection, connection.name
        return self

    async def __aexit__(self, *_: object) -> None:
        """End a press with a stop, then close."""
        # The error of the block is not passed on to the task group, which would wrap it in an ExceptionGroup.
        await self._stack.__aexit__(None, None, None)

    # State

    @property
    def state(self) -> State | None:
        """Newest state of the robot; None before the first."""
        return self._stream.newest

    @property
    def state_age_s(self) -> float:
        """Seconds since the newest state came; infinite before the first."""
        return self._stream.age_s

    @property
    def restarts(self) -> int:
        """Number of restarts of the robot program that were seen since this client was made."""
        return self._stream.restarts

    @property
    def link(self) -> LinkQuality:
        """Round trip, answered fraction and states per second."""
        return self._drive.meter.link(self._stream.per_s)

    @property
    def trouble(self) -> str:
        """Reason why the robot is not reached, as far as the network tells; empty while it is."""
        return self._open.sender.trouble

    def states(self) -> AsyncIterator[State]:
        """Yield the newest state and each later one until the client closes; a slow reader misses some."""
        return self._stream.states()

    @property
    def watching(self) -> bool:
        """True while the teacher looks at the robot; only then is the robot told that its teacher is there."""
        return self._drive.watching

    @watching.setter
    def watching(self, watching: bool) -> None:
        self._drive.watching = watching

    # Queries

    async def hello(self) -> Hello:
        """Return the robot's description: its task, actions, sensors and size. Raises NoAnswerError."""
        hello = await self._open.sender.query(requests.HelloRequest(), hello_of)
        self._stream.on_answer(hello.boot, hello.tick)
        return hello

    async def health(self) -> HealthReport | None:
        """Return the health of the robot's program; None in its first second. Raises NoAnswerError."""
        return await self._open.sender.query(
            requests.HealthRequest(), lambda body: None if body.get("health") is None else HEALTH.read(body["health"])
        )

    async def why(self) -> DecisionFacts | None:
        """Return the facts behind the robot's newest decision; None before its first tick. Raises NoAnswerError."""
        return await self._open.sender.query(
            requests.WhyRequest(), lambda body: None if body.get("why") is None else FACTS.read(body["why"])
        )

    async def world(self) -> WorldView | None:
        """Return the simulated world; None for a real robot. Raises NoAnswerError."""
        return await self._open.sender.query_simulated(requests.WorldRequest(), WORLD.read)

    async def lessons(self, count: int = 10) -> tuple[LessonLine, ...]:
        """Return the newest lessons, newest first; `count` is at most 20. Raises NoAnswerError."""
        return await self._open.sender.query(
            requests.LessonsRequest(count), lambda body: LESSONS.read(body.get("lessons"))
        )

    async def situations(self) -> tuple[str, ...]:
        """Return the names that situations of the mid level have, sorted. Raises NoAnswerError."""
        return await self._open.sender.query(
            requests.SituationsRequest(), lambda body: SITUATIONS.read(body.get("situations"))
        )

    async def exam(self) -> ExamStatus | None:
        """Return the status of the newest exam; None for a robot that is not simulated in its own program.

        Raises NoAnswerError.
        """
        return await self._open.sender.query_simulated(
            requests.ExamStatusRequest(), lambda body: EXAM.read(body.get("exam"))
        )

    async def file_parts(self, name: str) -> AsyncIterator[FilePart]:
        """Yield the parts of a file that `save` or `export` made on the robot, in order, at least one.

        Raises RefusedError if the robot does not have the file, NoAnswerError.
        """
        offset = 0
        while True:
            part = await self._open.sender.file_part(requests.FileRequest(name, offset))
            yield part
            offset += len(part.content)
            if offset >= part.size_bytes or not part.content:
                return

    async def simulation(self) -> SimulationView | None:
        """Return the simulated world and task, and those to choose from. Raises NoAnswerError.

        Returns None for a robot that is not simulated in its own program.
        """
        return await self._open.sender.query_simulated(
            requests.SimulationRequest(), lambda body: SIMULATION.read(body.get("simulation"))
        )

    # Connection

    @property
    def _open(self) -> Connection:
        if self._connection is None:
            raise RuntimeError(
                f"the client is not open; use it as: async with {type(self).__name__}(folder) as robot: ..."
            )
        return self._connection

    @property
    def _drive(self) -> ManualDrive:
        return self._open.drive

    async def _ticks(self, seconds: float) -> int:
        """Return a time in ticks of this robot."""
        if self._period_s is None:
            self._period_s = (await self.hello()).period_s
        return round(seconds / self._period_s)
