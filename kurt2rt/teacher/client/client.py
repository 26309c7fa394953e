"""A teacher's device in Python: see the robot, teach it, drive it, over the network.

async with TeacherClient(Path("var/devices/phone")) as robot:
    await robot.take()
    async for state in robot.states():
        if state.cause == "unknown":
            await robot.answer("forward", of=state.tick)
"""

import hashlib
import secrets
import time
from collections.abc import Callable
from contextlib import AsyncExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

import anyio

from kurt2rt.channel.protocol.requests import (
    UPLOAD_ID_BYTES,
    UPLOAD_PART_BYTES,
    BackToStartRequest,
    LoadRequest,
    MoveWallRequest,
    NextRunRequest,
    PlaceRequest,
    SimulationRequest,
    SpeedRequest,
    UploadRequest,
)
from kurt2rt.channel.protocol.simulation import SIMULATION, SimulationView
from kurt2rt.teacher.client.answer import Answer, RefusedError
from kurt2rt.teacher.client.connection import open_connection
from kurt2rt.teacher.client.goals import GoalsMixin
from kurt2rt.teacher.client.lessons import LessonsMixin
from kurt2rt.teacher.client.motion import MotionMixin
from kurt2rt.teacher.client.request_sender import facts_of
from kurt2rt.teacher.client.session import SessionMixin
from kurt2rt.teacher.client.transport import Response

ANSWER_WITHIN_S = 3.5
_PART_EACH_S = 0.008


class TeacherClient(LessonsMixin, GoalsMixin, SessionMixin, MotionMixin):
    """An async context manager: inside it pictures come, and while this device is in charge the robot is told that its
    teacher is there.

    Commands are sent again every 0.1 s, count once, and come back with the robot's `Answer`; a refusal is one, too.
    They raise NoAnswerError when nobody answered for 3.5 s: then it is not known whether they counted. A stop overtakes
    whatever else is under way. Speeds are in metres per second, ways in metres, angles in radians. One program at a
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
        """`folder` is the device's side of a pairing; `host` and `port` of the robot are those noted there, if None.

        `patience_s` is how long an answer is waited for; `now` a monotonic clock in seconds.
        """
        super().__init__(now)
        self.name = folder.name
        self._folder = folder
        self._host = host
        self._port = port
        self._patience_s = patience_s
        self._now = now
        self._stack = AsyncExitStack()

    async def __aenter__(self) -> Self:
        """Open the pairing and begin to observe. The robot need not be there yet. Raises CredentialsError."""
        connection = await self._stack.enter_async_context(
            open_connection(self._folder, self._host, self._port, self._pictures, self._patience_s, self._now)
        )
        self._connection, self.name = connection, connection.name
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End a press with a stop, then close."""
        # The error of the block is not shown to the task group, which would wrap it.
        await self._stack.__aexit__(None, None, None)

    # The simulated world

    async def move_wall(self, name: str, dx: float, dy: float) -> Answer:
        """Shift a wall or an obstacle."""
        return await self._asking.command(MoveWallRequest, name=name, dx_m=dx, dy_m=dy)

    async def place(self, x: float, y: float, heading: float) -> Answer:
        """Put the robot down elsewhere."""
        return await self._asking.command(PlaceRequest, x_m=x, y_m=y, heading_rad=heading)

    async def put_back(self) -> Answer:
        """Put the robot down where its run began."""
        return await self._asking.command(BackToStartRequest)

    async def simulation(self) -> SimulationView | None:
        """Return what is simulated; None for a robot that is not simulated in its own program."""

        def read(response: Response) -> SimulationView | None:
            return None if response.code.startswith("4.04") else SIMULATION.read(facts_of(response).get("simulation"))

        return await self._asking.told(SimulationRequest(), read)

    async def next_run(self, world: str | None = None, task: str | None = None, *, fresh: bool = False) -> Answer:
        """End the present run and begin the next one, where the robot stands until `resume`.

        `world`, `task`: None: the present ones. `fresh`: with a knowledge file that holds nothing; the present one is
        kept under another name.
        """
        return await self._asking.command(NextRunRequest, world=world, task=task, fresh=fresh)

    async def set_speed(self, times: int) -> Answer:
        """Let the time of a simulated robot pass `times` as fast as real time, 1 to 10, or as near as it comes."""
        return await self._asking.command(SpeedRequest, times=times)

    async def load(self, content: bytes) -> Answer:
        """Begin the next run with this knowledge, an archive of `export` or a knowledge file; as `next_run`.

        It is uploaded first, at up to 100 kB a second.
        """
        upload = secrets.token_bytes(UPLOAD_ID_BYTES)
        try:
            await self.upload(upload, content)
        except RefusedError as error:
            return error.answer or Answer(False, "refused", str(error), -1)
        return await self.load_upload(upload, hashlib.sha256(content).digest())

    async def upload(self, upload: bytes, content: bytes) -> None:
        """Bring a file to the robot's memory under the random id `upload`. Raises RefusedError, NoAnswerError."""
        state = await self._asking.picture()
        for offset in range(0, len(content), UPLOAD_PART_BYTES):
            part = content[offset : offset + UPLOAD_PART_BYTES]
            began_s = self._now()
            answer = await self._asking.ask(UploadRequest(state.boot, upload, offset, part))
            if not answer.accepted:
                raise RefusedError(answer.text or answer.why, answer)
            # More requests a second than this the robot throws away.
            await anyio.sleep(max(0.0, _PART_EACH_S - (self._now() - began_s)))

    async def load_upload(self, upload: bytes, sha256: bytes) -> Answer:
        """Begin the next run with a file that was uploaded."""
        return await self._asking.command(LoadRequest, upload=upload, sha256=sha256)
