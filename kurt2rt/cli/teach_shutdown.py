"""End of a teacher's program: a signal, or the end of its pairing."""

import signal

import anyio
import anyio.to_thread

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import Device, read_device
from kurt2rt.platform.signal_handlers import heeded_signals

_POLL_PAIRING_S = 1.0


async def until_teaching_ends(device: Device, *, command: str = "teach") -> str:
    """Wait for a signal, or the end of the device's pairing.

    Returns the reason in a line for the user, which names the `command` to start again; empty if the user asked for
    the end.
    """
    reason = ""
    async with anyio.create_task_group() as tasks:

        async def pairing_ends() -> None:
            nonlocal reason
            reason = await _until_pairing_ends(device, command)
            tasks.cancel_scope.cancel()

        tasks.start_soon(pairing_ends)
        await until_ended()
        tasks.cancel_scope.cancel()
    return reason


async def until_ended() -> None:
    """Return after a signal that ends the program."""
    with anyio.open_signal_receiver(*heeded_signals(signal.SIGTERM, signal.SIGINT, signal.SIGHUP)) as signals:
        await anext(signals)


async def _until_pairing_ends(device: Device, command: str) -> str:
    """Wait until the pairing is renewed or revoked; return the reason in a line for the user."""
    while True:
        await anyio.sleep(_POLL_PAIRING_S)
        try:
            now = await anyio.to_thread.run_sync(read_device, device.folder)
        except CredentialsError:
            return f"{device.name}: its pairing was revoked; pair it again: kurt2rt pair {device.name}"
        if now.token != device.token:
            return f"{device.name}: its pairing was renewed; start kurt2rt {command} again"
