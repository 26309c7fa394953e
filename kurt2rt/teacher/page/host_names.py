"""Which names of this machine a browser may have used: a page that came under another name is somebody else's."""

import ipaddress
import socket
from collections.abc import Collection


def host_name(host: str) -> str:
    """The name or address in a Host header, lower case, without port and brackets; empty for a header that is none."""
    host = host.strip().lower()
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0].rstrip(".")


def own_names() -> frozenset[str]:
    """Names that this machine has without an address."""
    name = socket.gethostname().lower()
    short = name.partition(".")[0]
    return frozenset({name, short, f"{short}.local"})


def is_ours(host: str, local_address: str, names: Collection[str]) -> bool:
    """Whether a Host header means this machine: the address that the connection came to, or one of `names`.

    This is what stops DNS rebinding: a foreign name that was made to lead here is neither.
    """
    name = host_name(host)
    here = _address(local_address)
    if here is None:
        return False
    if name == "localhost":
        return here.is_loopback
    address = _address(name)
    if address is not None:
        return address == here
    return name in names


def _address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        address = ipaddress.ip_address(text)
    except ValueError:
        return None
    # A socket for both kinds of addresses calls an IPv4 one ::ffff:a.b.c.d.
    if isinstance(address, ipaddress.IPv6Address) and address.ipv4_mapped is not None:
        return address.ipv4_mapped
    return address


def own_address() -> str:
    """Address under which the machines around can reach this one; that of loopback where there is no network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # Chooses the interface of the default route; a datagram socket sends nothing when it connects.
            probe.connect(("192.0.2.1", 9))
        except OSError:
            return "127.0.0.1"
        address: str = probe.getsockname()[0]
    return "127.0.0.1" if ipaddress.ip_address(address).is_unspecified else address
