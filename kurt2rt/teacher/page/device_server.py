"""Serves the pages of this machine and of every device that is paired, also of one that is paired meanwhile."""

from collections.abc import Awaitable, Callable, Collection
from dataclasses import dataclass
from pathlib import Path

import anyio
import anyio.to_thread

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import LOCAL, OF_THIS_MACHINE, Device, pairing_names, read_device
from kurt2rt.teacher.page.device_pages import DevicePages, OpenLink
from kurt2rt.teacher.page.host_names import own_address
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.served_pages import PageAddress, ServedPages
from kurt2rt.teacher.page.server import Doorway

_LOOK_AT_PAIRINGS_S = 1.0


@dataclass(frozen=True, slots=True)
class Pairings:
    """The folders of both sides of all pairings."""

    teachers: Path
    devices: Path


def devices_here(pairings: Pairings) -> tuple[tuple[Device, ...], str]:
    """Return the devices whose pages can be served from this machine, and what is wrong with others, in a line.

    First this machine's own, then those that were paired and whose side was not moved away, the newest first.
    Raises CredentialsError when the folder of pairings cannot be read.
    """
    found: list[tuple[float, Device]] = []
    troubles = []
    for name in pairing_names(pairings.teachers):
        folder = pairings.devices / name
        if name != LOCAL and (name in OF_THIS_MACHINE or not folder.is_dir()):
            continue
        try:
            paired_s = float("inf") if name == LOCAL else folder.stat().st_ctime
            found.append((paired_s, read_device(folder)))
        except (CredentialsError, OSError) as error:
            troubles.append(str(error))
    found.sort(key=lambda each: each[0], reverse=True)
    return tuple(device for _, device in found), "; ".join(troubles)


async def run_device_pages(
    pairings: Pairings,
    open_link: OpenLink,
    robot_place: str,
    names: Collection[str],
    port: int,
    tell: Callable[[ServedPages], None],
    told_to_end: Callable[[], Awaitable[None]],
    *,
    further: int = 0,
    look_s: float = _LOOK_AT_PAIRINGS_S,
) -> None:
    """Serve until `told_to_end` returns; the network only while a device is paired. Raises PageError, CredentialsError.

    `names` are this machine's in an address; `tell` is called with what is served, at first and after each change.
    `look_s`: between two looks who is paired. `port` and `further` as `kurt2rt.teacher.page.server.listen` has them.
    """
    async with anyio.create_task_group() as links:
        pages = DevicePages(links, open_link, robot_place, names)
        async with anyio.create_task_group() as serving:
            doorway = Doorway(pages, serving, port, further=further)
            found = (await anyio.to_thread.run_sync(devices_here, pairings))[0]
            await doorway.open(everywhere=_needs_network(found))
            async with anyio.create_task_group() as following:
                following.start_soon(_follow, pairings, pages, doorway, tell, look_s)
                await told_to_end()
                following.cancel_scope.cancel()
            await pages.end()
            doorway.end()
        links.cancel_scope.cancel()


async def _follow(
    pairings: Pairings, pages: DevicePages, doorway: Doorway, tell: Callable[[ServedPages], None], look_s: float
) -> None:
    """Serve who is paired, and the network or not; tell of every change."""
    found: tuple[Device, ...] = ()
    told = None
    while True:
        try:
            found, trouble = await anyio.to_thread.run_sync(devices_here, pairings)
        except CredentialsError as error:
            trouble = str(error)  # a disk that fails is no reason to lose the teacher
        pages.serve(found)
        try:
            await doorway.open(everywhere=_needs_network(found))
        except PageError as error:
            trouble = f"{trouble}; {error}".strip("; ")
        served = ServedPages(
            tuple(PageAddress(each.name, _link(each, doorway.port)) for each in found),
            doorway.everywhere is True,
            trouble,
        )
        if served != told:
            tell(served)
            told = served
        await anyio.sleep(look_s)


def _needs_network(devices: Collection[Device]) -> bool:
    return any(each.name not in OF_THIS_MACHINE for each in devices)


def _link(device: Device, port: int) -> str:
    return page_link(device, "127.0.0.1" if device.name in OF_THIS_MACHINE else own_address(), port)


def page_link(device: Device, host: str, port: int) -> str:
    """Return what a browser opens to be let in to a device's page."""
    shown = f"[{host}]" if ":" in host else host
    return f"http://{shown}:{port}/pair?token={device.token}"
