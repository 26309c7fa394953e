"""Commands about a simulated robot, its world and its runs."""

import hashlib
import secrets

import anyio

from kurt2rt.channel.protocol import requests
from kurt2rt.channel.protocol.limits import UPLOAD_ID_BYTES, UPLOAD_PART_BYTES
from kurt2rt.teacher.client.answer import Answer, RefusedError
from kurt2rt.teacher.client.command_client import CommandClient

_PART_EACH_S = 0.008


class SimulationCommands(CommandClient):
    """Changes of world, pose and speed of a simulated robot, and of the run that it is in."""

    async def move_wall(self, name: str, dx_m: float, dy_m: float) -> Answer:
        """Shift a named wall or obstacle of the simulated world by (dx_m, dy_m), in m. Raises NoAnswerError."""
        return await self._command(requests.MoveWallRequest, name=name, dx_m=dx_m, dy_m=dy_m)

    async def place(self, x_m: float, y_m: float, heading_rad: float) -> Answer:
        """Put the simulated robot, standing, at a pose in m and rad. Raises NoAnswerError."""
        return await self._command(requests.PlaceRequest, x_m=x_m, y_m=y_m, heading_rad=heading_rad)

    async def put_back(self) -> Answer:
        """Put the simulated robot, standing, at the start of its run. Raises NoAnswerError."""
        return await self._command(requests.BackToStartRequest)

    async def next_run(self, world: str | None = None, task: str | None = None, *, fresh: bool = False) -> Answer:
        """End the present run and begin the next one, in which the robot stands until `resume`.

        Args:
            world: World by name. None: the present one.
            task: Task by name. None: the present one.
            fresh: Begin with an empty knowledge file; the present file is kept under another name.

        Raises:
            NoAnswerError: The robot does not answer.
        """
        return await self._command(requests.NextRunRequest, world=world, task=task, fresh=fresh)

    async def set_speed(self, times: int) -> Answer:
        """Set the speed of a simulated robot's time, 1 to 10 times real time; a slow machine reaches less.

        Raises NoAnswerError.
        """
        return await self._command(requests.SpeedRequest, times=times)

    async def load(self, content: bytes) -> Answer:
        """Upload knowledge at up to 100 kB/s and begin the next run with it.

        `content` is an archive of `export` or a knowledge file. Raises NoAnswerError.
        """
        upload = secrets.token_bytes(UPLOAD_ID_BYTES)
        try:
            await self.upload(upload, content)
        except RefusedError as error:
            return error.answer or Answer(False, "refused", str(error), -1)
        return await self.load_upload(upload, hashlib.sha256(content).digest())

    async def upload(self, upload: bytes, content: bytes) -> None:
        """Upload a file into the robot's memory under the random id `upload`, for `load_upload`.

        Raises RefusedError if the robot refuses a part, NoAnswerError.
        """
        sender = self._open.sender
        state = await sender.state()
        for offset in range(0, len(content), UPLOAD_PART_BYTES):
            part = content[offset : offset + UPLOAD_PART_BYTES]
            began_s = self._now()
            answer = await sender.send(requests.UploadRequest(state.boot, upload, offset, part))
            if not answer.accepted:
                raise RefusedError(answer.text or answer.why, answer)
            # The robot drops more than 200 requests a second of one key.
            await anyio.sleep(max(0.0, _PART_EACH_S - (self._now() - began_s)))

    async def load_upload(self, upload: bytes, sha256: bytes) -> Answer:
        """Begin the next run with an uploaded file; `sha256` is the hash of its content. Raises NoAnswerError."""
        return await self._command(requests.LoadRequest, upload=upload, sha256=sha256)
