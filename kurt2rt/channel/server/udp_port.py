"""UDP port of the robot."""

import errno
import ipaddress
import socket

from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.protocol.udp_socket import open_udp_socket


def require_port(host: str, port: int) -> None:
    """Check that the UDP port can be opened at an address of this machine. Raises ChannelError with the reason."""
    bound_socket(host, port).close()


def bound_socket(host: str, port: int) -> socket.socket:
    """Return a UDP socket bound to an address of this machine, "::" for all, of IPv4 where IPv6 is missing.

    Port 0 binds a free port. Raises ChannelError.
    """
    try:
        address = ipaddress.ip_address(host)
    except ValueError as error:
        raise ChannelError(
            f"{host!r} is not an address", do="give one of this machine, such as 127.0.0.1 or ::"
        ) from error
    try:
        return open_udp_socket(f"::ffff:{address}" if address.version == 4 else str(address), port)
    except (OSError, OverflowError) as error:
        raise ChannelError(_why(error, host, port)) from error


def _why(error: OSError | OverflowError, host: str, port: int) -> str:
    match error:
        case OSError(errno=errno.EADDRINUSE):
            return f"UDP port {port} is in use, by another kurt2rt run perhaps; end that one, or give another port"
        case OSError(errno=errno.EADDRNOTAVAIL | errno.EAFNOSUPPORT):
            return f"{host} is not an address of this machine; give one of its own, or :: for all"
        case OSError(errno=errno.EACCES):
            return f"UDP port {port} is not allowed to this user; give one above 1023"
        case _:
            return f"UDP port {port} at {host} cannot be opened ({error}); give another port or address"
