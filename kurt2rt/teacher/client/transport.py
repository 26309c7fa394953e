"""OSCORE-protected requests to one robot: the only user of aiocoap on the teacher's side.

Plain requests with `protect` and `unprotect` around them: aiocoap's own OSCORE client leaks two tasks for each answer
that is lost, and its number limits end observations.
"""

import asyncio
import logging
import socket
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import aiocoap
import anyio.to_thread
from aiocoap import oscore
from aiocoap.numbers.constants import TransportTuning
from aiocoap.pipe import Pipe
from aiocoap.transports.udp6 import MessageInterfaceUDP6, UDP6EndpointAddress
from aiocoap.util import hostportjoin

from kurt2rt.channel.protocol.codec import CONTENT_FORMAT
from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.protocol.udp_socket import Ipv4Socket, mapped, open_udp_socket
from kurt2rt.channel.security.context_folder import SECRET, CredentialsError
from kurt2rt.channel.security.oscore_context import OscoreContext

_LOGGER = "kurt2rt.teacher-client"
_LARGEST_DATAGRAM = 65_536
"""aiocoap reads 4 kB otherwise; a world with many walls is longer."""


class _Loose(TransportTuning):  # type: ignore[misc]  # Any
    """Tuning of messages that are sent once: the caller sends them again until they are answered."""

    reliability = False


class _Registering(TransportTuning):  # type: ignore[misc]  # Any
    """Tuning of registrations: sent three times in 0.4 s, given up after 0.9 s, before the next one begins after 1 s.

    aiocoap sends one confirmable message at a time and drops those that wait for one that is given up.
    """

    reliability = True
    ACK_TIMEOUT = 0.13
    ACK_RANDOM_FACTOR = 1.0
    MAX_RETRANSMIT = 2


@dataclass(frozen=True, slots=True)
class Response:
    """Answer of the robot to one request, decrypted and authenticated."""

    code: str
    """Code such as "2.04 Changed"."""
    payload: bytes
    number: int
    """Observe number, which grows with each state of one observation; -1 if the answer has none."""

    @property
    def successful(self) -> bool:
        """True if the request was carried out (code class 2)."""
        return self.code.startswith("2.")


OnResponse = Callable[[Response], None]


class Exchange:
    """Handle of a request that waits for its answer, or of an observation that gets states until it ends."""

    def __init__(self) -> None:
        self.ended = False
        """Whether it was answered, failed, or was ended."""
        self._stop: Callable[[], object] | None = None

    def end(self) -> None:
        """End the exchange and drop later answers. Ending twice does nothing."""
        self.ended = True
        stop, self._stop = self._stop, None
        if stop is not None:
            stop()

    def _begin(self, stop: Callable[[], object]) -> None:
        self._stop = stop


class OscoreRequests:
    """Open socket with the device's side of a pairing. Sending never waits and never raises."""

    def __init__(self, coap: Any, keys: OscoreContext, host: str, port: int, paired_ms: int) -> None:
        """Use `open_requests`."""
        self.trouble = ""
        """Reason why the robot is not reached, as far as the network tells; empty after each answer of the robot."""
        self.damaged = 0
        """Number of answers that were forged, or changed on their way."""
        self._coap = coap
        self._keys = keys
        self._host = host
        self._port = port
        self._paired_ms = paired_ms
        self._robot: Any = None

    @property
    def next_number(self) -> int:
        """Number that grows with each message, across restarts of this program and renewals of the pairing.

        It is the pairing's sequence number plus the time of the pairing in ms; no clock sets it back.
        """
        number: int = self._keys.sender_sequence_number
        return self._paired_ms + number

    async def find_robot(self) -> None:
        """Resolve the robot's address again, because it may have changed; a failure goes to `trouble`."""
        try:
            robot = await self._resolve()
        except (aiocoap.error.Error, OSError, ValueError) as error:
            self.trouble = f"{self._host} is not found: {error}"
        else:
            self._robot = robot

    def post(self, path: str, payload: bytes, on_response: OnResponse) -> Exchange:
        """Send a request once; `on_response` is called at most once, from the event loop."""
        request = aiocoap.Message(code=aiocoap.POST, payload=payload, transport_tuning=_Loose())
        request.opt.content_format = CONTENT_FORMAT
        return self._begin(path, request, on_response)

    def observe(self, path: str, on_response: OnResponse) -> Exchange:
        """Observe a resource (RFC 7641) until the exchange ends, or the robot ends it.

        `on_response` is called for each state, from the event loop.
        """
        request = aiocoap.Message(code=aiocoap.GET, transport_tuning=_Registering())
        request.opt.observe = 0
        return self._begin(path, request, on_response)

    async def close(self) -> None:
        """Close the socket and store the state of the pairing."""
        await self._coap.shutdown()
        await anyio.to_thread.run_sync(self._keys.close)

    async def _resolve(self) -> Any:
        interface = self._coap.request_interfaces[0].token_interface.message_interface
        if isinstance(interface.transport.get_extra_info("socket"), Ipv4Socket):
            # aiocoap would look for a route with an IPv6 socket.
            kind, family = socket.SOCK_DGRAM, socket.AF_INET
            found = await self._coap.loop.getaddrinfo(self._host, self._port, family=family, type=kind)
            return UDP6EndpointAddress(mapped(found[0][4]), interface)
        probe = aiocoap.Message(code=aiocoap.GET, uri=f"coap://{hostportjoin(self._host, self._port)}")
        await self._coap.find_remote_and_interface(probe)
        return probe.remote

    def _begin(self, path: str, request: Any, on_response: OnResponse) -> Exchange:
        exchange = Exchange()
        request.opt.uri_path = tuple(path.strip("/").split("/"))
        self._send(request, exchange, on_response, prove=True)
        return exchange

    def _send(self, request: Any, exchange: Exchange, on_response: OnResponse, *, prove: bool) -> None:
        if self._robot is None:
            exchange.end()
            return
        try:
            outer, request_id = self._keys.protect(request)
        except oscore.ContextUnavailable as error:
            self.trouble = str(error)
            exchange.end()
            return
        outer.remote = self._robot
        pipe = Pipe(outer, self._coap.log)

        def on_event(event: Any) -> bool:
            if exchange.ended:
                return False
            if event.exception is not None:
                self.trouble = f"nothing is heard of {self._host}: {event.exception}"
                exchange.end()
                return False
            message = self._unprotected(event.message, request_id)
            if message is None:
                if event.is_last:
                    exchange.end()
                return not event.is_last
            self.trouble = ""
            if prove and message.code == aiocoap.UNAUTHORIZED and message.opt.echo is not None:
                # The robot was restarted and asks for a proof that this is no replay (RFC 8613, B.1.2).
                self._send(request.copy(echo=message.opt.echo), exchange, on_response, prove=False)
                return False
            if event.is_last:
                exchange.end()
            number = -1 if message.opt.observe is None else message.opt.observe
            on_response(Response(str(message.code), message.payload, number))
            return not (event.is_last or exchange.ended)

        exchange._begin(pipe.on_event(on_event))
        self._coap.request_interfaces[0].request(pipe)

    def _unprotected(self, message: Any, request_id: Any) -> Any:
        try:
            plain, _ = self._keys.unprotect(message, request_id)
        except oscore.NotAProtectedMessage:
            self.damaged += 1
            if message.code == aiocoap.UNAUTHORIZED:
                self.trouble = "the robot says that it does not know this device; pair it: kurt2rt pair"
            return None
        except Exception:  # noqa: BLE001 - forged bytes make the library raise many things, and none is an answer
            self.damaged += 1
            return None
        return plain


async def open_requests(folder: Path, host: str, port: int) -> OscoreRequests:
    """Open a socket for a device's pairing in `folder`, locked until `close`; the robot need not be there.

    Raises ChannelError, and CredentialsError if the pairing is the cause.
    """
    keys, paired_ms = await anyio.to_thread.run_sync(_open_keys, folder)
    try:
        # No warnings either: on a bad link aiocoap logs hundreds; `trouble` holds the reason.
        logging.getLogger(_LOGGER).setLevel(logging.CRITICAL)
        opened = open_udp_socket()
    except OSError as error:
        keys.close()
        raise ChannelError(f"no UDP socket can be opened ({error.strerror})", do="switch on IPv4 or IPv6") from error
    loop = asyncio.get_running_loop()
    coap = aiocoap.Context(loop=loop, loggername=_LOGGER)
    await coap._append_tokenmanaged_messagemanaged_transport(
        lambda messages: MessageInterfaceUDP6._create_transport_endpoint(opened, messages, coap.log, loop)
    )
    coap.request_interfaces[0].token_interface.message_interface.transport.max_size = _LARGEST_DATAGRAM
    requests = OscoreRequests(coap, keys, host, port, paired_ms)
    await requests.find_robot()
    return requests


def _open_keys(folder: Path) -> tuple[OscoreContext, int]:
    keys = OscoreContext(folder)
    try:
        return keys, (folder / SECRET).stat().st_mtime_ns // 1_000_000
    except OSError as error:
        keys.close()
        raise CredentialsError(f"cannot be looked at ({error})", where=folder / SECRET) from error
