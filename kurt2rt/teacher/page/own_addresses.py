"""Addresses at which a phone reaches the page of this machine."""

import ipaddress
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import psutil

AUTO: Final = "auto"
"""Value of `page_address` that stands for this machine's addresses in its networks."""
NO_ADDRESS: Final = (
    "no phone can reach this machine: it is in no network; connect it to one, open a hotspot, or name its address "
    "with --page-address"
)
_INTERFACES = Path("/sys/class/net")


def addresses_for_phones(named: str) -> tuple[str, ...]:
    """Return `named`, or for `auto` this machine's addresses, the likeliest first; empty if it is in no network.

    Private networks come before public ones, bridges of containers after both, and tunnels such as a VPN's last.
    An interface with an IPv4 address is reached by it; IPv6 addresses are listed for interfaces without.
    """
    if named != AUTO:
        return (named,)
    return tuple(address for _, address in sorted(_ranked(), key=lambda each: each[0]))


def _ranked() -> Iterator[tuple[tuple[bool, ...], str]]:
    stats = psutil.net_if_stats()
    for name, entries in psutil.net_if_addrs().items():
        # An interface may end between the two calls.
        flags = stats[name].flags.split(",") if name in stats and stats[name].isup else ["loopback"]
        found = () if "loopback" in flags else _addresses(tuple(str(each.address) for each in entries))
        for address in found:
            virtual = (_INTERFACES / name).exists() and not (_INTERFACES / name / "device").exists()
            yield ("pointopoint" in flags, virtual, address.is_link_local, not address.is_private), str(address)


def _addresses(texts: tuple[str, ...]) -> list[ipaddress.IPv4Address] | list[ipaddress.IPv6Address]:
    """Return the IPv4 addresses of an interface, or if it has none its IPv6 addresses beyond the link's own."""
    parsed = [each for text in texts if (each := _parse(text)) is not None and not each.is_loopback]
    four = [each for each in parsed if isinstance(each, ipaddress.IPv4Address)]
    # A browser cannot open an address with a scope such as fe80::1%wlan0.
    return four or [each for each in parsed if isinstance(each, ipaddress.IPv6Address) and not each.is_link_local]


def _parse(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(text)
    except ValueError:
        return None  # the hardware address
