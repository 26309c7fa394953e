"""`kurt2rt teach` without --terminal or --auto: the page of one device, or with --phone those of all."""

import math
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial

import anyio
from rich.console import Console

from kurt2rt.channel.security.pairing import LOCAL, OF_THIS_MACHINE, Device, local_pairing
from kurt2rt.cli.live_screen import PAIR_A_PHONE
from kurt2rt.cli.qr_code import print_code
from kurt2rt.cli.teach_shutdown import until_ended, until_teaching_ends
from kurt2rt.platform.text_table import print_lines
from kurt2rt.service.settings import ServiceSettings
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.device_pages import PageSite
from kurt2rt.teacher.page.device_server import FindDevices, local_devices, run_device_pages
from kurt2rt.teacher.page.host_names import own_names
from kurt2rt.teacher.page.own_addresses import AUTO
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.public_address import public_address as parse_public_address
from kurt2rt.teacher.page.served_pages import ServedPages, to_line

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
    as_json: bool
    """Report the served pages in lines of JSON, for `kurt2rt run`."""

    @property
    def names(self) -> frozenset[str]:
        """Names of this machine and of --page-address, in lower case, as browsers may write them in an address."""
        return own_names() | ({self.address.lower()} - {AUTO})


def serve_page(device: Device, options: PageOptions, public_address: str | None = None) -> None:
    """Serve the page of a device until a signal or the end of the input ends it.

    Args:
        device: paired device, with the address of the robot.
        options: of the page.
        public_address: address of a TLS proxy in front of the page, such as https://robot.example.

    Raises:
        PageError: no TCP port is free, the public address is invalid, or the device's pairing was revoked or renewed.
        CredentialsError: the pairing cannot be opened.
    """
    site = PageSite(
        lambda device: TeacherClient(device.folder, device.host, device.port),
        f"{device.host}:{device.port}",
        options.names,
        options.address,
        None if public_address is None else parse_public_address(public_address),
        address_command="kurt2rt teach" + ("" if device.name == LOCAL else f" --device {device.name}"),
        idle_s=math.inf,
    )
    reason = ""

    async def end() -> None:
        nonlocal reason
        reason = await until_teaching_ends(device)

    _serve(lambda: ((device,), ""), site, options, end, at_once=True)
    if reason:
        raise PageError(reason)


def serve_pages(service: ServiceSettings, port: int, options: PageOptions) -> None:
    """Serve this machine's page and, while devices are paired, theirs on the network, until told to end.

    It makes this machine's pairing if it is missing. `port` is the UDP port of the robot, which is this machine.

    Raises:
        PageError: no TCP port is free.
        CredentialsError: the folder of pairings cannot be read or written.
    """
    local_pairing(*service.pairings, port=service.port)
    site = PageSite(
        lambda device: TeacherClient(device.folder, ROBOT_HERE, port),
        f"{ROBOT_HERE}:{port}",
        options.names,
        options.address,
    )

    _serve(partial(local_devices, service.pairings), site, options, until_ended, at_once=False)


def _serve(
    find: FindDevices, site: PageSite, options: PageOptions, end: Callable[[], Awaitable[None]], *, at_once: bool
) -> None:
    publish = _print_json if options.as_json else _printer(Console(), site.robot_place)
    serve = partial(run_device_pages, at_once=at_once, spare_ports=options.spare_ports)
    anyio.run(serve, find, site, options.port, publish, end)


def _print_json(served: ServedPages) -> None:
    print(to_line(served), flush=True)


def _printer(console: Console, robot_place: str) -> Callable[[ServedPages], None]:
    def print_pages(served: ServedPages) -> None:
        for each in served.addresses:
            print_lines(console, f"page for {each.device}, robot at {robot_place}; Ctrl-C ends", each.link, whole=True)
        phones = [each for each in served.addresses if each.device not in OF_THIS_MACHINE]
        if phones and console.is_terminal:
            print_code(console, phones[0].link)
        print_lines(console, *([] if served.network else [PAIR_A_PHONE]), *([served.trouble] if served.trouble else []))

    return print_pages
