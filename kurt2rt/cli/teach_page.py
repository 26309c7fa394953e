"""`kurt2rt teach` without --terminal or --auto: the page of one device, or with --phone those of all."""

from collections.abc import Callable
from pathlib import Path

import anyio
from rich.console import Console

from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, Device, local_pairing
from kurt2rt.cli.live_screen import PAIR_A_PHONE
from kurt2rt.cli.qr_code import qr_code
from kurt2rt.cli.teach_shutdown import end_of_teaching, told_to_end
from kurt2rt.service.settings import ServiceSettings
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.device_server import Pairings, page_link, run_device_pages
from kurt2rt.teacher.page.host_names import own_address, own_names
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.public_address import public_address as read_public_address
from kurt2rt.teacher.page.served_pages import PageAddress, ServedPages, to_line
from kurt2rt.teacher.page.server import listen, run_page

FURTHER_PORTS = 9
"""Number of ports above that of the settings to try if another page has it."""
ROBOT_HERE = "127.0.0.1"


def serve_page(
    device: Device,
    host: str,
    port: int,
    page_port: int,
    host_names: tuple[str, ...],
    *,
    further: int,
    while_stdin: bool,
    public_address: str | None = None,
    as_json: bool = False,
) -> None:
    """Serve the page of a device until it is told to end; `host` and `port` are the robot's.

    `further`: as `kurt2rt.teacher.page.server.listen` has it.
    `public_address` is where a TLS proxy serves it, such as https://robot.example.
    `as_json`: tell the address in a line of JSON, for `kurt2rt run`. Raises PageError.
    """
    public = None if public_address is None else read_public_address(public_address)
    everywhere = device.name not in OF_THIS_MACHINE
    listener = listen(page_port, everywhere=everywhere, further=further)
    served_port: int = listener.getsockname()[1]
    if public is None:
        link = page_link(device, own_address() if everywhere else ROBOT_HERE, served_port)
    else:
        link = f"{public.origin}/pair?token={device.token}"
    access = Access(device.name, device.token, own_names() | {each.lower() for each in host_names}, public)
    if as_json:
        _tell_json(ServedPages((PageAddress(device.name, link),), network=everywhere, trouble=""))
    else:
        _tell_link(link, device.name, f"{host}:{port}", (page_port, served_port), code=everywhere or public is not None)
    because = ""

    async def end() -> None:
        nonlocal because
        because = await end_of_teaching(device, while_stdin=while_stdin)

    async def serve() -> None:
        async with TeacherClient(device.folder, host, port) as client:
            await run_page(client, access, f"{host}:{port}", listener, end)

    with listener:
        anyio.run(serve)
    if because:
        raise PageError(because)


def serve_pages(
    service: ServiceSettings,
    port: int,
    page_port: int,
    host_names: tuple[str, ...],
    *,
    further: int,
    while_stdin: bool,
    as_json: bool,
) -> None:
    """Serve this machine and, while a device is paired, the network, until told to end. Raises PageError.

    `port` is the robot's, on this machine; `further` as `kurt2rt.teacher.page.server.listen` has it.
    `as_json`: tell what is served in lines of JSON, for `kurt2rt run`.
    """
    pairings = Pairings(Path(service.teachers), Path(service.devices))
    local_pairing(pairings.teachers, pairings.devices, port=service.port)
    names = own_names() | {each.lower() for each in host_names}

    async def serve() -> None:
        await run_device_pages(
            pairings,
            lambda device: TeacherClient(device.folder, ROBOT_HERE, port),
            f"{ROBOT_HERE}:{port}",
            names,
            page_port,
            _tell_json if as_json else _telling(Console()),
            lambda: told_to_end(while_stdin=while_stdin),
            further=further,
        )

    anyio.run(serve)


def _tell_link(link: str, device: str, robot_place: str, ports: tuple[int, int], *, code: bool) -> None:
    console, (wanted, served) = Console(), ports
    taken = f"; port {wanted} is in use, so it is at {served}" if wanted not in (0, served) else ""
    _print(console, f"page for {device}, robot at {robot_place}{taken}; Ctrl-C ends", link)
    if code and console.is_terminal:
        console.print(qr_code(link), soft_wrap=True)


def _tell_json(served: ServedPages) -> None:
    print(to_line(served), flush=True)


def _telling(console: Console) -> Callable[[ServedPages], None]:
    def tell(served: ServedPages) -> None:
        for each in served.addresses:
            _print(console, f"page for {each.device}:", each.link)
        phones = [each for each in served.addresses if each.device not in OF_THIS_MACHINE]
        if phones and console.is_terminal:
            console.print(qr_code(phones[0].link), soft_wrap=True)
        _print(console, *([] if phones else [PAIR_A_PHONE]), *([served.trouble] if served.trouble else []))

    return tell


def _print(console: Console, *lines: str) -> None:
    if lines:
        console.print(*lines, sep="\n", markup=False, highlight=False, soft_wrap=True)
