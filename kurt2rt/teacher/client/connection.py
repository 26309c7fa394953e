"""What an open `TeacherClient` consists of, and how it is opened and closed."""

import secrets
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

import anyio
import anyio.to_thread

from kurt2rt.channel.protocol.requests import COMMAND_ID_BYTES, StopRequest
from kurt2rt.channel.security.pairing import PORT, Device, read_device
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.client.manual_drive import BEAT_S, ManualDrive
from kurt2rt.teacher.client.request_sender import RequestSender
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.stop_sender import StopSender
from kurt2rt.teacher.client.subscribe import observe
from kurt2rt.teacher.client.transport import OscoreRequests, open_requests

_STOP_WITHIN_S = 0.5


class Connection:
    """A device that is heard by its robot: requests out, pictures in, and the teacher's hand."""

    def __init__(
        self, name: str, requests: OscoreRequests, asking: RequestSender, stopping: StopSender, hand: ManualDrive
    ) -> None:
        self.name = name
        """Of the device, and so of the teacher."""
        self.requests = requests
        self.asking = asking
        self.stopping = stopping
        self.hand = hand

    async def release(self, hold: int | None) -> Answer | None:
        """End a press with a stop that ends no later one; None when that press is not on. Raises NoAnswerError."""
        if hold is None or hold != self.hand.hold:
            return None
        self.hand.end()
        return await self.asking.ask(StopRequest(secrets.token_bytes(COMMAND_ID_BYTES), hold))

    async def release_anyhow(self, hold: int | None) -> None:
        """The same at the end of everything."""
        # The robot lets go by itself when it hears nothing, so a stop that nobody answers is no error here.
        with anyio.move_on_after(_STOP_WITHIN_S), suppress(NoAnswerError):
            await self.release(hold)


@asynccontextmanager
async def open_connection(
    folder: Path,
    host: str | None,
    port: int | None,
    pictures: StateStream,
    patience_s: float,
    now: Callable[[], float],
) -> AsyncIterator[Connection]:
    """Open a pairing and observe its robot, which need not be there yet; a press that is on ends with a stop.

    Raises CredentialsError.
    """
    device = await anyio.to_thread.run_sync(_read_device, folder)
    requests = await open_requests(folder, host or device.host, port or device.port)
    asking = RequestSender(requests, pictures, patience_s)
    try:
        async with anyio.create_task_group() as tasks:
            stopping = StopSender(asking, tasks)
            hand = ManualDrive(device.name, pictures, requests, now=now, on_begin=stopping.wish_anew)
            connection = Connection(device.name, requests, asking, stopping, hand)
            tasks.start_soon(observe, requests, pictures, now)
            tasks.start_soon(_beat, hand)
            try:
                yield connection
            finally:
                with anyio.CancelScope(shield=True):
                    await connection.release_anyhow(hand.hold)
                tasks.cancel_scope.cancel()
                hand.forget()
    finally:
        pictures.close()
        with anyio.CancelScope(shield=True):
            await requests.close()


async def _beat(hand: ManualDrive) -> None:
    due_s = anyio.current_time()
    while True:
        hand.beat()
        # No burst after a pause: what was missed is missed.
        due_s = max(due_s + BEAT_S, anyio.current_time())
        await anyio.sleep_until(due_s)


def _read_device(folder: Path) -> Device:
    if not (folder / "device.json").exists():
        return Device(folder, folder.name, "127.0.0.1", PORT, "")
    return read_device(folder)
