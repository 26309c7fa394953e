"""When a teacher's program ends: told to by a signal, its input is over, or its pairing is no more."""

import asyncio
import signal
import sys
import threading

import anyio
import anyio.to_thread

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import Device, read_device

_LOOK_AT_PAIRING_S = 1.0


async def end_of_teaching(device: Device, *, while_stdin: bool) -> str:
    """Wait for it. Returns why, in a line for the user; empty where he wanted it so."""
    because = ""
    async with anyio.create_task_group() as tasks:

        async def pairing_ends() -> None:
            nonlocal because
            because = await _end_of_pairing(device)
            tasks.cancel_scope.cancel()

        tasks.start_soon(pairing_ends)
        await told_to_end(while_stdin=while_stdin)
        tasks.cancel_scope.cancel()
    return because


async def told_to_end(*, while_stdin: bool) -> None:
    """Wait for a signal that ends the program, or with `while_stdin` for the end of its input."""
    async with anyio.create_task_group() as tasks:

        async def input_ends() -> None:
            await _end_of_input()
            tasks.cancel_scope.cancel()

        if while_stdin:
            tasks.start_soon(input_ends)
        with anyio.open_signal_receiver(signal.SIGTERM, signal.SIGINT, signal.SIGHUP) as signals:
            async for _ in signals:
                tasks.cancel_scope.cancel()


async def _end_of_pairing(device: Device) -> str:
    """Wait until the pairing is renewed or revoked; what to tell then."""
    while True:
        await anyio.sleep(_LOOK_AT_PAIRING_S)
        try:
            now = await anyio.to_thread.run_sync(read_device, device.folder)
        except CredentialsError:
            return f"{device.name}: its pairing was revoked; pair it again: kurt2rt pair {device.name}"
        if now.token != device.token:
            return f"{device.name}: its pairing was renewed; start kurt2rt teach anew"


async def _end_of_input() -> None:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()

    def read() -> None:
        for _ in sys.stdin:
            continue
        try:
            loop.call_soon_threadsafe(ended.set)
        except RuntimeError:
            return  # the loop has ended before the input did

    # Daemon: reading cannot be interrupted, and must not keep the process alive.
    threading.Thread(target=read, name="standard input", daemon=True).start()
    await ended.wait()
