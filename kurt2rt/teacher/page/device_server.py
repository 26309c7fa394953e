"""Server of the pages of this machine and of all paired devices, which follows changes of the pairings."""

from collections.abc import Awaitable, Callable, Collection
from itertools import chain

import anyio
import anyio.to_thread

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import LOCAL, OF_THIS_MACHINE, Device, PairingFolders, pairing_names, read_device
from kurt2rt.teacher.page.device_pages import DevicePages, PageSite
from kurt2rt.teacher.page.own_addresses import NO_ADDRESS
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.served_pages import ServedPages
from kurt2rt.teacher.page.server import PagePort

_POLL_PAIRINGS_S = 1.0

FindDevices = Callable[[], tuple[tuple[Device, ...], str]]
"""Returns devices, and the faults of others in a line (or empty). Raises CredentialsError."""


def local_devices(pairings: PairingFolders) -> tuple[tuple[Device, ...], str]:
    """Return the devices whose pages this machine can serve, and the faults of others in a line (or empty).

    This machine's own comes first, then those that were paired and whose folder was not moved away, the newest first.
    Raises CredentialsError if the folder of pairings cannot be read.
    """
    found: list[tuple[float, Device]] = []
    faults = []
    for name in pairing_names(pairings.teachers):
        folder = pairings.devices / name
        if name != LOCAL and (name in OF_THIS_MACHINE or not folder.is_dir()):
            continue
        try:
            paired_s = float("inf") if name == LOCAL else folder.stat().st_ctime
            found.append((paired_s, read_device(folder)))
        except (CredentialsError, OSError) as error:
            faults.append(str(error))
    found.sort(key=lambda each: each[0], reverse=True)
    return tuple(device for _, device in found), "; ".join(faults)


async def run_device_pages(
    find: FindDevices,
    site: PageSite,
    port: int,
    publish: Callable[[ServedPages], None],
    until_ended: Callable[[], Awaitable[None]],
    *,
    at_once: bool = False,
    spare_ports: int = 0,
    poll_s: float = _POLL_PAIRINGS_S,
) -> None:
    """Serve until `until_ended` returns; the network only while a device is paired. Raises PageError, CredentialsError.

    Args:
        find: returns the devices to serve, as `local_devices`; called in a thread, again and again.
        site: settings of the pages.
        port: TCP port, 0: any.
        publish: gets the served pages, at first and after each change.
        until_ended: returns when the program has to end.
        at_once: open the links to the robot before a browser shows a page.
        spare_ports: as for `kurt2rt.teacher.page.server.listen`.
        poll_s: time between two reads of the pairings.
    """
    async with anyio.create_task_group() as links:
        pages = DevicePages(links, site)
        async with anyio.create_task_group() as serving:
            page_port = PagePort(pages, serving, port, spare_ports=spare_ports)
            found = (await anyio.to_thread.run_sync(find))[0]
            await page_port.open(everywhere=_needs_network(found))
            if at_once:
                pages.serve(found)
                await pages.open_links()
            async with anyio.create_task_group() as polling:
                polling.start_soon(_follow_pairings, find, pages, page_port, site, publish, poll_s)
                await until_ended()
                polling.cancel_scope.cancel()
            await pages.end()
            page_port.end()
        links.cancel_scope.cancel()


async def _follow_pairings(
    find: FindDevices,
    pages: DevicePages,
    page_port: PagePort,
    site: PageSite,
    publish: Callable[[ServedPages], None],
    poll_s: float,
) -> None:
    found: tuple[Device, ...] = ()
    published = None
    while True:
        try:
            found, fault = await anyio.to_thread.run_sync(find)
        except CredentialsError as error:
            fault = str(error)  # the devices found before stay served: a faulty disk must not end teaching
        pages.serve(found)
        try:
            await page_port.open(everywhere=_needs_network(found))
        except PageError as error:
            fault = f"{fault}; {error}".strip("; ")
        of_devices = [site.addresses(each, page_port.port) for each in found]
        if not all(of_devices):
            fault = f"{fault}; {NO_ADDRESS}".strip("; ")
        served = ServedPages(tuple(chain.from_iterable(of_devices)), page_port.everywhere is True, fault)
        if served != published:
            publish(served)
            published = served
        await anyio.sleep(poll_s)


def _needs_network(devices: Collection[Device]) -> bool:
    return any(each.name not in OF_THIS_MACHINE for each in devices)
