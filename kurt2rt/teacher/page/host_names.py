"""Names and addresses of this machine in the Host header of a browser."""

import ipaddress
import socket
from collections.abc import Collection

_LOCAL_DOMAINS = ("local", "lan", "home.arpa", "fritz.box", "home", "internal")
"""Domains that mDNS and routers put behind a machine's name; no stranger can have a name there."""


def host_name(host: str) -> str:
    """Return name or address of a Host header, in lower case, without port and brackets; empty if there is none."""
    host = host.strip().lower()
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0].rstrip(".")


def own_names() -> frozenset[str]:
    """Return this machine's names, addresses left out."""
    name = socket.gethostname().lower()
    short = name.partition(".")[0]
    return frozenset({name, short, *(f"{short}.{domain}" for domain in _LOCAL_DOMAINS)})


def is_own_host(host: str, local_address: str, names: Collection[str]) -> bool:
    """Return whether a Host header means this machine: the local address of the connection, or one of `names`.

    A foreign name that resolves to this machine (DNS rebinding) is neither.
    """
    name = host_name(host)
    here = _parse_address(local_address)
    if here is None:
        return False
    if name == "localhost":
        return here.is_loopback
    address = _parse_address(name)
    if address is not None:
        return address == here or name in names
    return name in names


def is_loopback(address: str) -> bool:
    """Return whether an IP address is one of the loopback interface."""
    parsed = _parse_address(address)
    return parsed is not None and parsed.is_loopback


def _parse_address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        address = ipaddress.ip_address(text)
    except ValueError:
        return None
    # A dual-stack socket reports an IPv4 address as ::ffff:a.b.c.d.
    if isinstance(address, ipaddress.IPv6Address) and address.ipv4_mapped is not None:
        return address.ipv4_mapped
    return address
