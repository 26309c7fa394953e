"""End of a teacher's program: a signal, the end of its standard input, or the end of its pairing."""

import asyncio
import signal
import sys
import threading

import anyio
import anyio.to_thread

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import Device, read_device
from kurt2rt.platform.signal_handlers import heeded_signals

_POLL_PAIRING_S = 1.0


async def until_teaching_ends(device: Device, *, while_stdin: bool, command: str = "teach") -> str:
    """Wait for a signal, the end of the input (`while_stdin`) or of the device's pairing.

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
        await until_ended(while_stdin=while_stdin)
        tasks.cancel_scope.cancel()
    return reason


async def until_ended(*, while_stdin: bool) -> None:
    """Return after a signal that ends the program, or with `while_stdin` at the end of its input."""
    async with anyio.create_task_group() as tasks:

        async def input_ends() -> None:
            await _until_input_ends()
            tasks.cancel_scope.cancel()

        if while_stdin:
            tasks.start_soon(input_ends)
        ends = heeded_signals(signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
        with anyio.open_signal_receiver(*ends) as signals:
            async for _ in signals:
                tasks.cancel_scope.cancel()


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


async def _until_input_ends() -> None:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()

    def read() -> None:
        for _ in sys.stdin:
            continue
        try:
            loop.call_soon_threadsafe(ended.set)
        except RuntimeError:
            return  # the loop has ended before the input did

    # Daemon thread: a read cannot be interrupted, and must not keep the process alive.
    threading.Thread(target=read, name="standard input", daemon=True).start()
    await ended.wait()
