"""`kurt2rt teach`."""

import asyncio
import signal
import sys
import threading
from pathlib import Path
from typing import Annotated

import anyio
import anyio.to_thread
import segno
import typer
from rich.console import Console

from kurt2rt.channel.credentials import LOCAL, Device, local_pairing, read_device
from kurt2rt.channel.error import CredentialsError
from kurt2rt.page.access import Access
from kurt2rt.page.hosts import own_address, own_names
from kurt2rt.page.server import PageError, listen, run_page
from kurt2rt.service_settings import ServiceSettings, load_service
from kurt2rt.teaching.client import TeacherClient

_LOOK_AT_PAIRING_S = 1.0


def teach(
    name: Annotated[
        str, typer.Option("--as", help="Paired device whose page this is; local: this machine's own teacher.")
    ] = LOCAL,
    robot: Annotated[
        str | None, typer.Option(help="Address of the robot. Default: as noted when the device was paired.")
    ] = None,
    port: Annotated[
        int | None, typer.Option(min=1, max=65535, help="UDP port of the robot. Default: as noted with the pairing.")
    ] = None,
    page_port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="TCP port of the page; 0: any. Default: as the settings say.")
    ] = None,
    host_name: Annotated[
        list[str] | None, typer.Option(help="Another name of this machine that browsers may use; can be repeated.")
    ] = None,
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default",
    while_stdin: Annotated[
        bool, typer.Option("--while-stdin", help="End when the standard input ends, as kurt2rt run needs it.")
    ] = False,
) -> None:
    """Serve the teacher's page: see the robot, teach it and drive it from a browser.

    Start the robot first, in another terminal, then open the address that this
    prints:

        kurt2rt run
        kurt2rt teach

    For a phone, pair it once and scan the code; the page is then open to the
    phone's network:

        kurt2rt pair phone
        kurt2rt teach --as phone

    The robot needs not be there yet, and may come and go. Ends on Ctrl-C; a robot
    that is driven by hand stands first.
    """
    service = load_service(settings)
    device = _device(service, name)
    host, at = robot or device.host, port or device.port
    everywhere = name != LOCAL
    listener = listen(service.page_port if page_port is None else page_port, everywhere=everywhere)
    address = own_address() if everywhere else "127.0.0.1"
    link = f"http://{address}:{listener.getsockname()[1]}/pair?token={device.token}"
    access = Access(name, device.token, own_names() | {each.lower() for each in host_name or ()})
    console = Console()
    console.print(f"page for {name}, robot at {host}:{at}; Ctrl-C ends", markup=False, highlight=False, soft_wrap=True)
    console.print(link, markup=False, highlight=False, soft_wrap=True)
    if everywhere and console.is_terminal:
        segno.make(link).terminal(compact=True)
    ended_because = ""

    async def told_to_end() -> None:
        nonlocal ended_because
        async with anyio.create_task_group() as tasks:

            async def pairing_ends() -> None:
                nonlocal ended_because
                ended_because = await _end_of_pairing(device)
                tasks.cancel_scope.cancel()

            async def input_ends() -> None:
                await _end_of_input()
                tasks.cancel_scope.cancel()

            tasks.start_soon(pairing_ends)
            if while_stdin:
                tasks.start_soon(input_ends)
            with anyio.open_signal_receiver(signal.SIGTERM, signal.SIGINT, signal.SIGHUP) as signals:
                async for _ in signals:
                    tasks.cancel_scope.cancel()

    async def serve() -> None:
        async with TeacherClient(device.folder, host, at) as client:
            await run_page(client, access, f"{host}:{at}", listener, told_to_end)

    with listener:
        anyio.run(serve)
    if ended_because:
        raise PageError(ended_because)


def _device(service: ServiceSettings, name: str) -> Device:
    if name == LOCAL:
        return local_pairing(Path(service.teachers), Path(service.devices), port=service.port).device
    return read_device(Path(service.devices) / name)


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
