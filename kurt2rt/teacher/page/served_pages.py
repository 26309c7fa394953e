"""Addresses of the pages that a program serves, as it reports them to the program that started it."""

import json
from dataclasses import asdict, dataclass

from kurt2rt.channel.security.pairing import Device


@dataclass(frozen=True, slots=True)
class PageAddress:
    """Address at which a device opens its page."""

    device: str
    link: str
    """It carries the token: a browser that opens it is that device."""


@dataclass(frozen=True, slots=True)
class ServedPages:
    """Pages served at present."""

    addresses: tuple[PageAddress, ...]
    """This machine's own first, then the others, the newest pairing first."""
    network: bool
    """The port is open to the network."""
    trouble: str
    """Fault of pairings or port, in a line; empty without a fault."""


NO_PAGES = ServedPages((), network=False, trouble="")


def page_link(device: Device, host: str, port: int) -> str:
    """Return the link that opens a device's page and pairs the browser."""
    shown = f"[{host}]" if ":" in host else host
    return f"http://{shown}:{port}/pair?token={device.token}"


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
