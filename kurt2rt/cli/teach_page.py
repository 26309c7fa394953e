"""`kurt2rt teach` without --terminal or --auto: the page of one device, or with --phone those of all."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import anyio
from rich.console import Console

from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, Device, local_pairing
from kurt2rt.cli.live_screen import PAIR_A_PHONE
from kurt2rt.cli.qr_code import print_code
from kurt2rt.cli.teach_shutdown import until_ended, until_teaching_ends
from kurt2rt.service.settings import ServiceSettings
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.device_pages import PageSite
from kurt2rt.teacher.page.device_server import Pairings, run_device_pages
from kurt2rt.teacher.page.host_names import own_names
from kurt2rt.teacher.page.own_addresses import AUTO, NO_ADDRESS
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.public_address import public_address as parse_public_address
from kurt2rt.teacher.page.served_pages import PageAddress, ServedPages, page_addresses, to_line
from kurt2rt.teacher.page.server import listen, run_page

SPARE_PORTS = 9
"""Number of ports above that of the settings to try if another page has it."""
ROBOT_HERE = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class PageOptions:
    """Options of `kurt2rt teach` that tell on which ports and addresses pages are served."""

    port: int
    """TCP port; 0: any."""
    spare_ports: int
    """Number of ports above to try, as for `kurt2rt.teacher.page.server.listen`."""
    address: str
    """Address or name of this machine for phones; auto: its addresses in its networks."""
    while_stdin: bool
    as_json: bool
    """Report the served pages in lines of JSON, for `kurt2rt run`."""

    @property
    def names(self) -> frozenset[str]:
        """Names of this machine and of --page-address, in lower case, as browsers may write them in an address."""
        return own_names() | ({self.address.lower()} - {AUTO})


def serve_page(device: Device, host: str, port: int, options: PageOptions, public_address: str | None = None) -> None:
    """Serve the page of a device until a signal or the end of the input ends it.

    Args:
        device: paired device.
        host: address of the robot.
        port: UDP port of the robot.
        options: of the page.
        public_address: address of a TLS proxy in front of the page, such as https://robot.example.

    Raises:
        PageError: no TCP port is free, the public address is invalid, or the device's pairing was revoked or renewed.
        CredentialsError: the pairing cannot be opened.
    """
    public = None if public_address is None else parse_public_address(public_address)
    everywhere = device.name not in OF_THIS_MACHINE
    listener = listen(options.port, everywhere=everywhere, spare_ports=options.spare_ports)
    served_port: int = listener.getsockname()[1]
    if public is None:
        addresses = page_addresses(device, options.address, served_port)
    else:
        addresses = (PageAddress(device.name, f"{public.origin}/pair?token={device.token}"),)
    access = Access(device.name, device.token, options.names, public)
    served = ServedPages(addresses, network=everywhere, trouble="" if addresses else NO_ADDRESS)
    if options.as_json:
        _print_json(served)
    else:
        ports = (options.port, served_port)
        _print_links(served, device.name, f"{host}:{port}", ports, code=everywhere or public is not None)
    reason = ""

    async def end() -> None:
        nonlocal reason
        reason = await until_teaching_ends(device, while_stdin=options.while_stdin)

    async def serve() -> None:
        async with TeacherClient(device.folder, host, port) as client:
            await run_page(client, access, f"{host}:{port}", listener, end)

    with listener:
        anyio.run(serve)
    if reason:
        raise PageError(reason)


def serve_pages(service: ServiceSettings, port: int, options: PageOptions) -> None:
    """Serve this machine's page and, while devices are paired, theirs on the network, until told to end.

    It makes this machine's pairing if it is missing. `port` is the UDP port of the robot, which is this machine.

    Raises:
        PageError: no TCP port is free.
        CredentialsError: the folder of pairings cannot be read or written.
    """
    pairings = Pairings(Path(service.teachers), Path(service.devices))
    local_pairing(pairings.teachers, pairings.devices, port=service.port)
    site = PageSite(
        lambda device: TeacherClient(device.folder, ROBOT_HERE, port),
        f"{ROBOT_HERE}:{port}",
        options.names,
        options.address,
    )

    async def serve() -> None:
        await run_device_pages(
            pairings,
            site,
            options.port,
            _print_json if options.as_json else _printer(Console()),
            lambda: until_ended(while_stdin=options.while_stdin),
            spare_ports=options.spare_ports,
        )

    anyio.run(serve)


def _print_links(served: ServedPages, device: str, robot_place: str, ports: tuple[int, int], *, code: bool) -> None:
    console, (wanted, port) = Console(), ports
    taken = f"; port {wanted} is in use, so it is at {port}" if wanted not in (0, port) else ""
    links = [each.link for each in served.addresses]
    _print(console, f"page for {device}, robot at {robot_place}{taken}; Ctrl-C ends", *(links or [served.trouble]))
    if code and links and console.is_terminal:
        print_code(console, links[0])


def _print_json(served: ServedPages) -> None:
    print(to_line(served), flush=True)


def _printer(console: Console) -> Callable[[ServedPages], None]:
    def print_pages(served: ServedPages) -> None:
        for each in served.addresses:
            _print(console, f"page for {each.device}:", each.link)
        phones = [each for each in served.addresses if each.device not in OF_THIS_MACHINE]
        if phones and console.is_terminal:
            print_code(console, phones[0].link)
        _print(console, *([] if served.network else [PAIR_A_PHONE]), *([served.trouble] if served.trouble else []))

    return print_pages


def _print(console: Console, *lines: str) -> None:
    if lines:
        console.print(*lines, sep="\n", markup=False, highlight=False, soft_wrap=True)
