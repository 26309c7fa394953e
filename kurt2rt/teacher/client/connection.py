"""Open connection of a teacher's device to its robot."""

import secrets
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import anyio
import anyio.to_thread

from kurt2rt.channel.protocol.codec import decode_state
from kurt2rt.channel.protocol.limits import COMMAND_ID_BYTES
from kurt2rt.channel.protocol.requests import StopRequest
from kurt2rt.channel.security.pairing import PORT, Device, read_device
from kurt2rt.core.message_fields import WireError
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.client.manual_drive import BEAT_S, ManualDrive, PressHandle
from kurt2rt.teacher.client.request_sender import RequestSender
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.stop_sender import StopSender
from kurt2rt.teacher.client.transport import OscoreRequests, Response, open_requests

_STOP_WITHIN_S = 0.5
SILENT_AFTER_S = 1.0
"""Time without a state after which the observation is registered again."""
_POLL_S = 0.1
_STATE = "/state"


@dataclass(frozen=True, slots=True)
class Connection:
    """Parts of an open client that share one socket: requests, stops, and the stream of presses."""

    name: str
    """Name of the device, and so of the teacher."""
    requests: OscoreRequests
    sender: RequestSender
    stops: StopSender
    drive: ManualDrive

    async def end_press(self, press_id: int | None) -> Answer | None:
        """End a press with a stop that ends no later press, and return the answer; None if that press is not on.

        Raises NoAnswerError.
        """
        if press_id is None or press_id != self.drive.press_id:
            return None
        self.drive.end()
        return await self.sender.send(StopRequest(secrets.token_bytes(COMMAND_ID_BYTES), press_id))

    async def try_end_press(self, press_id: int | None) -> None:
        """End a press before closing: wait at most 0.5 s for the robot's answer."""
        # Without messages the robot stops by itself, so a missing answer is no error here.
        with anyio.move_on_after(_STOP_WITHIN_S), suppress(NoAnswerError):
            await self.end_press(press_id)

    @asynccontextmanager
    async def ending(self, handle: PressHandle) -> AsyncIterator[None]:
        """End the press of a handle at the end of the block; after an error wait at most 0.5 s for the answer.

        Raises NoAnswerError.
        """
        try:
            yield
        except BaseException:
            with anyio.CancelScope(shield=True):
                await self.try_end_press(handle.press_id)
            raise
        handle.released = await self.end_press(handle.press_id)


@asynccontextmanager
async def open_connection(
    folder: Path,
    host: str | None,
    port: int | None,
    stream: StateStream,
    patience_s: float,
    now: Callable[[], float],
) -> AsyncIterator[Connection]:
    """Open a pairing and subscribe to its robot, which need not be there yet; at the end stop a press that is on.

    Args:
        folder: of the device's pairing.
        host: address of the robot; None: that of the pairing.
        port: UDP port of the robot; None: that of the pairing.
        stream: gets the states.
        patience_s: time to wait for answers, in s.
        now: monotonic clock in s.

    Raises:
        ChannelError: no socket can be opened.
        CredentialsError: the pairing cannot be opened.
    """
    device = await anyio.to_thread.run_sync(_read_device, folder)
    requests = await open_requests(folder, host or device.host, port or device.port)
    sender = RequestSender(requests, stream, patience_s)
    try:
        async with anyio.create_task_group() as tasks:
            stops = StopSender(sender, tasks)
            drive = ManualDrive(device.name, stream, requests, now=now, on_begin=stops.supersede)
            connection = Connection(device.name, requests, sender, stops, drive)
            tasks.start_soon(subscribe, requests, stream, now)
            tasks.start_soon(_beat, drive)
            try:
                yield connection
            finally:
                with anyio.CancelScope(shield=True):
                    await connection.try_end_press(drive.press_id)
                tasks.cancel_scope.cancel()
                drive.close()
    finally:
        stream.close()
        with anyio.CancelScope(shield=True):
            await requests.close()


async def _beat(drive: ManualDrive) -> None:
    due_s = anyio.current_time()
    while True:
        drive.beat()
        # No burst after a pause: missed beats are not sent later.
        due_s = max(due_s + BEAT_S, anyio.current_time())
        await anyio.sleep_until(due_s)


def _read_device(folder: Path) -> Device:
    if not (folder / "device.json").exists():
        return Device(folder, folder.name, "127.0.0.1", PORT, "")
    return read_device(folder)


async def subscribe(requests: OscoreRequests, stream: StateStream, now: Callable[[], float]) -> None:
    """Observe the robot's states and fill `stream` with them until cancelled; observe again after a silence.

    `now`: monotonic clock in s.
    """
    while True:
        before, began_s, newest = stream.count, now(), -2

        def on_response(response: Response) -> None:
            nonlocal newest
            # Drops replayed states, and states that a newer one overtook.
            if response.number <= newest:
                return
            newest = response.number
            _publish(response, requests, stream)

        observation = requests.observe(_STATE, on_response)
        while True:
            await anyio.sleep(_POLL_S)
            came = stream.count > before
            if observation.ended and came:
                break
            if now() - began_s > SILENT_AFTER_S and stream.age_s > SILENT_AFTER_S:
                break
        observation.end()
        if stream.count == before:
            await requests.find_robot()  # it may have another address by now


def _publish(response: Response, requests: OscoreRequests, stream: StateStream) -> None:
    if not response.successful:
        requests.trouble = f"the robot sends no state: {response.code}"
        return
    try:
        state = decode_state(response.payload)
    except WireError as error:
        requests.trouble = (
            f"the robot's state is not understood ({error}), perhaps of another version; install the same kurt2rt on "
            "robot and device"
        )
    else:
        stream.publish(state)
