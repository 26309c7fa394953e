"""UDP socket of the robot under aiocoap; no datagram makes it fail."""

import asyncio
import errno
import ipaddress
import logging
import socket
import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import aiocoap
from aiocoap.error import ConRetransmitsExceeded
from aiocoap.message import Direction
from aiocoap.numbers.constants import TransportTuning
from aiocoap.transports.udp6 import MessageInterfaceUDP6, UDP6EndpointAddress

from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.protocol.udp_socket import open_udp_socket
from kurt2rt.channel.server.datagram_filter import Counters, DatagramFilter, Limits, SocketAddress
from kurt2rt.channel.server.sealed_request import SealedRequest


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


class Site(Protocol):
    """Answerer of all requests that reach an endpoint (a site of aiocoap); `RobotSite` is one."""

    async def render_to_pipe(self, pipe: Any) -> None:
        """Answer one request by adding responses to `pipe` (aiocoap.pipe.Pipe); called in a task of its own."""
        ...


class _Answered:
    """Robot's site that ends each request, because aiocoap keeps 7 kB for each one without an answer."""

    def __init__(self, site: Site) -> None:
        self._site = site
        self.tokens: Any = None
        """aiocoap's token manager."""

    async def render_to_pipe(self, pipe: Any) -> None:
        await self._site.render_to_pipe(pipe)
        key = (pipe.request.token, pipe.request.remote)
        kept, lose_interest = self.tokens.incoming_requests.get(key, (None, None))
        # The sender may have sent another request under this token meanwhile.
        if kept is not None and kept.request is pipe.request:
            lose_interest()


class _Brief(TransportTuning):  # type: ignore[misc]  # Any
    """Tuning that remembers a message as a possible duplicate for 10 s; OSCORE refuses duplicates without limit."""

    EXCHANGE_LIFETIME = 10.0


_BRIEF = _Brief()


class _Failures(logging.Handler):
    """Counter of errors that keeps the newest as text. It writes nowhere, because a terminal may block the loop."""

    def __init__(self, counters: Counters) -> None:
        super().__init__(logging.ERROR)
        self._counters = counters
        self.newest = ""

    def emit(self, record: logging.LogRecord) -> None:
        """Count an error that aiocoap logs."""
        self._counters.failed += 1
        self.newest = record.getMessage()


class _Socket(MessageInterfaceUDP6):  # type: ignore[misc]  # Any
    """UDP interface of aiocoap behind the datagram filter. No datagram makes it raise."""

    filter: DatagramFilter | None = None
    """None until aiocoap's upper layers are built; earlier datagrams are dropped."""

    def datagram_msg_received(
        self,
        data: bytes,
        ancdata: Sequence[tuple[int, int, bytes]],
        flags: int,  # noqa: ARG002 - aiocoap's signature
        address: SocketAddress,
    ) -> None:
        if self.filter is None:
            return
        try:
            if not self.filter.accepts(data, address):
                return
            packet_info = None
            for level, kind, content in ancdata:
                if (level, kind) == (socket.IPPROTO_IPV6, socket.IPV6_PKTINFO):
                    packet_info = content
            try:
                message = aiocoap.Message.decode(data, UDP6EndpointAddress(address, self, pktinfo=packet_info))
            except Exception:  # noqa: BLE001 - aiocoap's own error, but also UnicodeError and others for strange options
                self.filter.count_junk()
                return
            message.direction = Direction.INCOMING
            message.transport_tuning = _BRIEF
            self._ctx.dispatch_message(message)
        except Exception as error:  # noqa: BLE001 - the next datagram is read after any error
            self.log.error("a datagram of %d bytes: %r", len(data), error)  # noqa: TRY400 - one line

    def datagram_errqueue_received(
        self, data: bytes, ancdata: Sequence[tuple[int, int, bytes]], flags: int, address: SocketAddress
    ) -> None:
        try:
            super().datagram_errqueue_received(data, ancdata, flags, address)
        except Exception as error:  # noqa: BLE001
            self.log.error("an error report of the network: %r", error)  # noqa: TRY400

    def send(self, message: aiocoap.Message) -> None:
        """Send a message, unless the socket is closing: aiocoap's timers of empty ACKs (0.1 s) outlive its shutdown."""
        if self._shutting_down is None:
            super().send(message)

    def error_received(self, exc: OSError) -> None:
        # Later: this is called while a response is sent, and would end the exchange that sends it.
        remote = self._remote_being_sent_to.get()
        if remote is not None:
            self.loop.call_soon(self._give_up, exc, remote)

    def _give_up(self, failure: OSError, remote: UDP6EndpointAddress) -> None:
        """End the exchanges with a sender whose port is closed."""
        if self._shutting_down is not None:
            return
        try:
            self._ctx.dispatch_error(failure, remote)
        except Exception as error:  # noqa: BLE001
            self.log.error("%r: %r", failure, error)  # noqa: TRY400


class Endpoint:
    """Open UDP port of the channel, made by `open_endpoint`; it closes when this object is collected."""

    def __init__(
        self,
        context: aiocoap.Context,
        opened: _Socket,
        port: int,
        datagram_filter: DatagramFilter,
        counters: Counters,
        failures: _Failures,
    ) -> None:
        self._context = context
        self._socket = opened
        self._filter = datagram_filter
        self._failures = failures
        self.counters = counters
        self.port = port

    @property
    def newest_failure(self) -> str:
        """Newest error as text; empty if there was none."""
        return self._failures.newest

    @property
    def proven_senders(self) -> int:
        """Number of senders with a rate of their own."""
        return self._filter.proven_senders

    def mark_proven(self, remote: Any) -> None:
        """Give the sender of a request (its `remote`), which holds a key, a rate of its own."""
        self._filter.mark_proven(remote.sockaddr)

    async def close(self) -> None:
        """Close the port and end the requests under way."""
        self._socket.filter = None
        # Tasks that have not started start now: cancelled before, they leave a RuntimeWarning on the screen.
        await asyncio.sleep(0)
        await self._context.shutdown()


def _never(_: Any) -> bool:
    return False


def _unless_reachable(
    end_all: Callable[[Exception, Any], None], is_reachable: Callable[[Any], bool]
) -> Callable[[Exception, Any], None]:
    """Return `end_all`, which ends all observations of a sender, without effect on one that is certainly there."""

    def dispatch_error(error: Exception, remote: Any) -> None:
        # aiocoap ends all observations of a device for one message that it did not confirm in time.
        if not (isinstance(error, ConRetransmitsExceeded) and is_reachable(remote)):
            end_all(error, remote)

    return dispatch_error


async def open_endpoint(
    site: Site,
    host: str,
    port: int,
    *,
    limits: Limits | None = None,
    is_reachable: Callable[[Any], bool] = _never,
    key_of: Callable[[SealedRequest], Any] | None = None,
    now: Callable[[], float] = time.monotonic,
) -> Endpoint:
    """Listen on a UDP port.

    Raises ChannelError if the address is not of this machine, or another program has the port.

    Args:
        site: Answerer of the requests.
        host: Address of this machine, "::" for all.
        port: UDP port; 0 for a free one.
        limits: Rates of the datagram filter; None for the usual ones.
        is_reachable: Whether a sender (a request's `remote`) is certainly there, though it confirmed nothing.
        key_of: Security context that an OSCORE request names, or None.
        now: Monotonic clock in seconds.
    """
    loop = asyncio.get_running_loop()
    counters = Counters()
    datagram_filter = DatagramFilter(limits or Limits(), counters, now, key_of)
    failures = _Failures(counters)
    # Unregistered logger: aiocoap's lines about single messages are neither formatted nor passed on.
    log = logging.Logger("kurt2rt.channel.coap", logging.ERROR)
    log.addHandler(failures)
    answered = _Answered(site)
    context = aiocoap.Context(loop=loop, serversite=answered)
    context.log = log
    bound = bound_socket(host, port)

    await context._append_tokenmanaged_messagemanaged_transport(
        lambda messages: _Socket._create_transport_endpoint(bound, messages, log, loop)
    )
    (tokens,) = context.request_interfaces
    answered.tokens = tokens
    opened: _Socket = tokens.token_interface.message_interface
    opened.filter = datagram_filter
    tokens.dispatch_error = _unless_reachable(tokens.dispatch_error, is_reachable)
    return Endpoint(context, opened, bound.getsockname()[1], datagram_filter, counters, failures)
