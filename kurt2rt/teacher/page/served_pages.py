"""Addresses of the pages that a program serves, as it reports them to the program that started it."""

import json
from dataclasses import asdict, dataclass

from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, Device
from kurt2rt.teacher.page.own_addresses import addresses_for_phones


@dataclass(frozen=True, slots=True)
class PageAddress:
    """Link by which a device opens its page, with the token that logs it in."""

    device: str
    link: str
    """It carries the token: a browser that opens it is that device."""


@dataclass(frozen=True, slots=True)
class ServedPages:
    """Addresses of the page that are served now, and whether the network reaches them."""

    addresses: tuple[PageAddress, ...]
    """This machine's own first, then the others, the newest pairing first; of one device the likeliest first."""
    network: bool
    """The port is open to the network."""
    trouble: str
    """Fault of pairings or port, in a line; empty without a fault."""


NO_PAGES = ServedPages((), network=False, trouble="")


def page_link(device: Device, host: str, port: int) -> str:
    """Return the link that opens a device's page and pairs the browser."""
    shown = f"[{host}]" if ":" in host else host
    return f"http://{shown}:{port}/pair?token={device.token}"


def page_addresses(device: Device, named: str, port: int) -> tuple[PageAddress, ...]:
    """Return the addresses of a device's page, the likeliest first; empty if no phone can reach this machine.

    Args:
        device: paired device; a device of this machine has its page on loopback.
        named: address or name for phones; auto: this machine's addresses in its networks.
        port: TCP port of the page.
    """
    hosts = ("127.0.0.1",) if device.name in OF_THIS_MACHINE else addresses_for_phones(named)
    return tuple(PageAddress(device.name, page_link(device, host, port)) for host in hosts)


def to_line(served: ServedPages) -> str:
    """Return the pages as a line of JSON."""
    return json.dumps(asdict(served))


def from_line(line: str) -> ServedPages | None:
    """Parse a line of `to_line`; None for any other line."""
    try:
        fields = json.loads(line)
        addresses = tuple(PageAddress(str(each["device"]), str(each["link"])) for each in fields["addresses"])
        return ServedPages(addresses, bool(fields["network"]), str(fields["trouble"]))
    except (ValueError, KeyError, TypeError):
        return None
