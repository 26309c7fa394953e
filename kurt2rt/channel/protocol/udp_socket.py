"""UDP socket of both ends of the channel, for IPv6 and IPv4, or for IPv4 alone on a machine without IPv6."""

import errno
import socket
import struct
from collections.abc import Iterable
from typing import Any

MISSING_FAMILY = (errno.EAFNOSUPPORT, errno.EADDRNOTAVAIL)
"""Errors of a machine that lacks an address family, or has it without an address."""

_MAPPED = "::ffff:"
_ANY = "0.0.0.0"
_IP_RECVERR, _IPV6_RECVERR, _IP_PKTINFO = 11, 25, 8  # names that Python's socket lacks before 3.14
_IN_PKTINFO, _IN6_PKTINFO = struct.Struct("@i4s4s"), struct.Struct("@16sI")
_MAPPED_BYTES = bytes(10) + b"\xff\xff"

_Ancillary = tuple[int, int, bytes]


class Ipv4Socket(socket.socket):
    """IPv4 UDP socket with the interface of an IPv6 one, which aiocoap needs; mapped addresses (RFC 4291, 2.5.5.2)."""

    def __init__(self) -> None:
        super().__init__(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)

    def bind(self, address: Any) -> None:
        """Bind to (host, port); "::" is each address of this machine. Raises OSError, for other IPv6 hosts too."""
        host, port = address[:2]
        if ":" in host.removeprefix(_MAPPED) and host != "::":
            raise OSError(errno.EADDRNOTAVAIL, "no IPv6")
        super().bind((_ANY if host == "::" else host.removeprefix(_MAPPED), port))

    def setsockopt(self, level: int, option: int, value: Any) -> None:  # type: ignore[override]
        """Set an option; of IPv6's options the local address of each datagram alone has a meaning here."""
        if level != socket.IPPROTO_IPV6:
            super().setsockopt(level, option, value)
        elif option == socket.IPV6_RECVPKTINFO:
            super().setsockopt(socket.IPPROTO_IP, _IP_PKTINFO, value)

    def recvmsg(self, *sizes_and_flags: int) -> tuple[bytes, list[_Ancillary], int, Any]:
        """Return data, ancillary data, flags and sender as of an IPv6 socket. Raises OSError."""
        data, ancillary, flags, sender = super().recvmsg(*sizes_and_flags)
        return data, [_as_ipv6(*each) for each in ancillary], flags, mapped(sender)

    def sendmsg(
        self, buffers: Iterable[Any], ancillary: Iterable[Any] = (), flags: int = 0, address: Any = None, /
    ) -> int:
        """Send to a mapped address. Raises OSError, for other IPv6 addresses too."""
        host, port = address[:2]
        if not host.startswith(_MAPPED):
            raise OSError(errno.ENETUNREACH, "no IPv6")
        to = (host.removeprefix(_MAPPED), port)
        return super().sendmsg(buffers, [_as_ipv4(*each) for each in ancillary], flags, to)


def mapped(address: tuple[str, int]) -> tuple[str, int, int, int]:
    """Return an IPv4 host and port as the address that an IPv6 socket has for it (mapped address)."""
    return f"{_MAPPED}{address[0]}", address[1], 0, 0


def open_udp_socket(host: str = "::", port: int = 0) -> socket.socket:
    """Return a UDP socket bound to an address of this machine; "::" is all, port 0 a free one.

    `host`: IPv6 or mapped IPv4 address. Raises OSError, and OverflowError for a port beyond 65535.
    """
    try:
        return _opened(socket.socket(socket.AF_INET6, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC), host, port)
    except OSError as error:
        if error.errno not in MISSING_FAMILY:
            raise
    return _opened(Ipv4Socket(), host, port)


def _opened(opened: socket.socket, host: str, port: int) -> socket.socket:
    try:
        opened.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 0)
        # No SO_REUSEPORT: two robot programs would each get part of the teacher's messages.
        opened.bind((host, port))
    except (OSError, OverflowError):
        opened.close()
        raise
    return opened


def _as_ipv6(level: int, kind: int, content: bytes) -> _Ancillary:
    if (level, kind) == (socket.IPPROTO_IP, _IP_PKTINFO):
        interface, _, local = _IN_PKTINFO.unpack_from(content)
        return socket.IPPROTO_IPV6, socket.IPV6_PKTINFO, _IN6_PKTINFO.pack(_MAPPED_BYTES + local, interface)
    if (level, kind) == (socket.IPPROTO_IP, _IP_RECVERR):
        return socket.IPPROTO_IPV6, _IPV6_RECVERR, content
    return level, kind, content


def _as_ipv4(level: int, kind: int, content: bytes) -> _Ancillary:
    if (level, kind) != (socket.IPPROTO_IPV6, socket.IPV6_PKTINFO):
        return level, kind, content
    local, interface = _IN6_PKTINFO.unpack_from(content)
    return socket.IPPROTO_IP, _IP_PKTINFO, _IN_PKTINFO.pack(interface, local[len(_MAPPED_BYTES) :], bytes(4))
