"""`kurt2rt teach` without --terminal or --auto: the page."""

import anyio
import segno
from rich.console import Console

from kurt2rt.channel.credentials import OF_THIS_MACHINE, Device
from kurt2rt.cli.end_of_teaching import end_of_teaching
from kurt2rt.page.access import Access
from kurt2rt.page.error import PageError
from kurt2rt.page.hosts import own_address, own_names
from kurt2rt.page.public_address import public_address as read_public_address
from kurt2rt.page.server import listen, run_page
from kurt2rt.teaching.client import TeacherClient


def serve_page(
    device: Device,
    host: str,
    port: int,
    page_port: int,
    host_names: tuple[str, ...],
    *,
    while_stdin: bool,
    public_address: str | None = None,
) -> None:
    """Serve the page of a device until it is told to end; `host` and `port` are the robot's.

    `public_address` is where a TLS proxy serves it, such as https://robot.example. Raises PageError.
    """
    public = None if public_address is None else read_public_address(public_address)
    everywhere = device.name not in OF_THIS_MACHINE
    listener = listen(page_port, everywhere=everywhere)
    address = own_address() if everywhere else "127.0.0.1"
    origin = f"http://{address}:{listener.getsockname()[1]}" if public is None else public.origin
    link = f"{origin}/pair?token={device.token}"
    access = Access(device.name, device.token, own_names() | {each.lower() for each in host_names}, public)
    console = Console()
    console.print(f"page for {device.name}, robot at {host}:{port}; Ctrl-C ends", markup=False, highlight=False)
    console.print(link, markup=False, highlight=False, soft_wrap=True)
    if (everywhere or public is not None) and console.is_terminal:
        segno.make(link).terminal(compact=True)
    because = ""

    async def told_to_end() -> None:
        nonlocal because
        because = await end_of_teaching(device, while_stdin=while_stdin)

    async def serve() -> None:
        async with TeacherClient(device.folder, host, port) as client:
            await run_page(client, access, f"{host}:{port}", listener, told_to_end)

    with listener:
        anyio.run(serve)
    if because:
        raise PageError(because)
