"""Addresses of the pages that a program serves, as it tells them to the program that started it."""

import json
from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class PageAddress:
    """Address at which a device opens its page."""

    device: str
    link: str
    """Carries the token: who opens it is that device."""


@dataclass(frozen=True, slots=True)
class ServedPages:
    """Pages served at present."""

    addresses: tuple[PageAddress, ...]
    """This machine's own first, then the others, the one that was paired last before them."""
    network: bool
    """Whether the port is open to the network."""
    trouble: str
    """Fault of pairings or port, in a line; empty without a fault."""


NO_PAGES = ServedPages((), network=False, trouble="")


def to_line(served: ServedPages) -> str:
    """Return it as a line of JSON."""
    return json.dumps(asdict(served))


def from_line(line: str) -> ServedPages | None:
    """Return what `to_line` made a line of; None for any other line."""
    try:
        told = json.loads(line)
        addresses = tuple(PageAddress(str(each["device"]), str(each["link"])) for each in told["addresses"])
        return ServedPages(addresses, bool(told["network"]), str(told["trouble"]))
    except (ValueError, KeyError, TypeError):
        return None
