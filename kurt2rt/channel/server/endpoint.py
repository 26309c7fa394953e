"""The robot's UDP socket under aiocoap: one port, no matter what arrives there."""

import asyncio
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

from kurt2rt.channel.server.datagram_filter import Counters, DatagramFilter, Limits, SocketAddress
from kurt2rt.channel.server.sealed_request import SealedRequest
from kurt2rt.channel.server.udp_port import bound_socket


class Site(Protocol):
    """Answers requests."""

    async def render_to_pipe(self, pipe: Any) -> None:
        """Answer one request; called by aiocoap in a task of its own."""
        ...


class _Answered:
    """The robot's site, with an end for each request: aiocoap keeps one that is never answered, 7 kB, for ever."""

    def __init__(self, site: Site) -> None:
        self._site = site
        self.tokens: Any = None
        """aiocoap's token manager."""

    async def render_to_pipe(self, pipe: Any) -> None:
        await self._site.render_to_pipe(pipe)
        key = (pipe.request.token, pipe.request.remote)
        kept, lose_interest = self.tokens.incoming_requests.get(key, (None, None))
        # Under the same token the sender may have asked anew meanwhile.
        if kept is not None and kept.request is pipe.request:
            lose_interest()


class _Brief(TransportTuning):  # type: ignore[misc]  # Any
    """Each message is remembered as a possible duplicate for so long; OSCORE refuses duplicates for ever anyway."""

    EXCHANGE_LIFETIME = 10.0


_BRIEF = _Brief()


class _Failures(logging.Handler):
    """Counts what goes wrong and keeps the newest as text. It writes nowhere: a terminal may block, the loop not."""

    def __init__(self, counters: Counters) -> None:
        super().__init__(logging.ERROR)
        self._counters = counters
        self.newest = ""

    def emit(self, record: logging.LogRecord) -> None:
        """What aiocoap would log."""
        self._counters.failed += 1
        self.newest = record.getMessage()


class _Socket(MessageInterfaceUDP6):  # type: ignore[misc]  # Any
    """aiocoap's UDP interface behind a gate. Nothing that arrives makes it raise."""

    gate: DatagramFilter | None = None
    """None until aiocoap's layers above are put together; what comes earlier is as good as lost."""

    def datagram_msg_received(
        self,
        data: bytes,
        ancdata: Sequence[tuple[int, int, bytes]],
        flags: int,  # noqa: ARG002 - aiocoap's signature
        address: SocketAddress,
    ) -> None:
        if self.gate is None:
            return
        try:
            if not self.gate.admits(data, address):
                return
            packet_info = None
            for level, kind, content in ancdata:
                if (level, kind) == (socket.IPPROTO_IPV6, socket.IPV6_PKTINFO):
                    packet_info = content
            try:
                message = aiocoap.Message.decode(data, UDP6EndpointAddress(address, self, pktinfo=packet_info))
            except Exception:  # noqa: BLE001 - its own error, but also Unicode's and others for strange options
                self.gate.count_junk()
                return
            message.direction = Direction.INCOMING
            message.transport_tuning = _BRIEF
            self._ctx.dispatch_message(message)
        except Exception as error:  # noqa: BLE001 - whatever a datagram does, the next one is read
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
        # Not now: this comes out of the sending of a response, and would end the very exchange that is sending it.
        remote = self._remote_being_sent_to.get()
        if remote is not None:
            self.loop.call_soon(self._give_up, exc, remote)

    def _give_up(self, failure: OSError, remote: UDP6EndpointAddress) -> None:
        """Nobody listens there any more: end what is under way for him."""
        if self._shutting_down is not None:
            return
        try:
            self._ctx.dispatch_error(failure, remote)
        except Exception as error:  # noqa: BLE001
            self.log.error("%r: %r", failure, error)  # noqa: TRY400


class Endpoint:
    """An open port. Keep it: when it is collected, the port closes."""

    def __init__(
        self,
        context: aiocoap.Context,
        opened: _Socket,
        port: int,
        gate: DatagramFilter,
        counters: Counters,
        failures: _Failures,
    ) -> None:
        self._context = context
        self._socket = opened
        self._gate = gate
        self._failures = failures
        self.counters = counters
        self.port = port

    @property
    def newest_failure(self) -> str:
        """What went wrong last; empty while nothing did."""
        return self._failures.newest

    @property
    def proven_senders(self) -> int:
        """How many senders have a rate of their own."""
        return self._gate.proven_senders

    def proved(self, remote: Any) -> None:
        """The sender of a request (its `remote`) holds a key: it no longer shares the strangers' rate."""
        self._gate.proved(remote.sockaddr)

    async def close(self) -> None:
        """Close the port and end what is being answered."""
        self._socket.gate = None
        # Answers that have not begun begin now: one that is ended before leaves a complaint of Python on the screen.
        await asyncio.sleep(0)
        await self._context.shutdown()


def _nobody(_: Any) -> bool:
    return False


async def open_endpoint(
    site: Site,
    host: str,
    port: int,
    *,
    limits: Limits | None = None,
    hears: Callable[[Any], bool] = _nobody,
    key_of: Callable[[SealedRequest], Any] | None = None,
    now: Callable[[], float] = time.monotonic,
) -> Endpoint:
    """Listen on an address of this machine, "::" for all; port 0 takes a free one.

    `hears`: whether a sender (a request's `remote`) is there for certain, though it confirmed nothing. `key_of`: the
    security context that an OSCORE request names, or None.
    Raises ChannelError when the address is none of ours, or another program has the port.
    """
    loop = asyncio.get_running_loop()
    counters = Counters()
    gate = DatagramFilter(limits or Limits(), counters, now, key_of)
    failures = _Failures(counters)
    # Not registered anywhere: aiocoap's lines about single messages are neither formatted nor passed on.
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
    opened.gate = gate
    end_all = tokens.dispatch_error

    def dispatch_error(error: Exception, remote: Any) -> None:
        # aiocoap ends all that somebody observes for one message that he did not confirm in time.
        if not (isinstance(error, ConRetransmitsExceeded) and hears(remote)):
            end_all(error, remote)

    tokens.dispatch_error = dispatch_error
    return Endpoint(context, opened, bound.getsockname()[1], gate, counters, failures)
