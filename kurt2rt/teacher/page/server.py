"""TCP port and server of the pages."""

import contextlib
import errno
import os
import socket
from collections.abc import Iterator

import anyio
import anyio.abc
import uvicorn
from starlette.types import ASGIApp

from kurt2rt.channel.protocol.udp_socket import MISSING_FAMILY
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.uvicorn_protocols import REQUEST_WITHIN_S, ConnectionLimiter, TolerantWebSocket, limited_http

_MAX_CONNECTIONS = 96
"""Limit on all connections; ConnectionLimiter allows a third of them without a cookie."""


def listen(port: int, *, everywhere: bool, spare_ports: int = 0) -> socket.socket:
    """Return a listening TCP socket, on this machine alone or on all its addresses.

    If another program has `port`, the next `spare_ports` ports are tried in turn. Raises PageError if none is free.
    """
    for tried in range(port, min(port + spare_ports, 65535) + 1):
        try:
            return _listener(tried, everywhere=everywhere)
        except OSError as error:
            reason = os.strerror(error.errno or 0)  # without the address, which create_server adds
            if error.errno != errno.EADDRINUSE:
                break
    raise PageError(f"port {port}: cannot listen ({reason})", do="give another one with --page-port")


def _listener(port: int, *, everywhere: bool) -> socket.socket:
    """Return a socket of the usual family, or of the other one if this machine lacks the usual one. Raises OSError."""
    ipv6 = [(socket.AF_INET6, "::" if everywhere else "::ffff:127.0.0.1")] if socket.has_dualstack_ipv6() else []
    ipv4 = [(socket.AF_INET, "" if everywhere else "127.0.0.1")]
    for family, host in ipv6 + ipv4 if everywhere else ipv4 + ipv6:
        try:
            return socket.create_server((host, port), family=family, dualstack_ipv6=family == socket.AF_INET6)
        except OSError as error:
            failure = error
            if error.errno not in MISSING_FAMILY:
                break
    raise failure


class PagePort:
    """Port of an application, open to this machine alone or to the network; a change keeps open connections."""

    def __init__(
        self,
        app: ASGIApp,
        tasks: anyio.abc.TaskGroup,
        port: int,
        *,
        spare_ports: int = 0,
        request_within_s: float = REQUEST_WITHIN_S,
    ) -> None:
        """`port`, 0: any; `spare_ports` as for `listen`, for the first socket only."""
        self._app = app
        self._tasks = tasks
        self._spare_ports = spare_ports
        self._request_within_s = request_within_s
        self._servers: list[_Server] = []
        self.port = port
        self.everywhere: bool | None = None
        """The port is open to the network; None: it is closed."""

    async def open(self, *, everywhere: bool) -> None:
        """Listen on this machine alone, or on all its addresses. Raises PageError; the port is closed then."""
        if everywhere == self.everywhere:
            return
        for server in self._servers:
            for each in server.servers:
                each.close()
        self.everywhere = None
        listener = listen(self.port, everywhere=everywhere, spare_ports=self._spare_ports)
        self.port, self._spare_ports = listener.getsockname()[1], 0
        # The servers before stay in the list until `end`, for their open connections.
        server = await self._tasks.start(_serve, self._app, listener, self._request_within_s)
        self._servers.append(server)
        await server.listening.wait()
        self.everywhere = everywhere

    def end(self) -> None:
        """Close the port and every connection."""
        for server in self._servers:
            server.should_exit = True


class _Server(uvicorn.Server):
    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.listening = anyio.Event()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self.listening.set()

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave the signals to the command, which stops the robot before it ends the server."""
        yield


async def _serve(
    app: ASGIApp,
    listener: socket.socket,
    request_within_s: float,
    *,
    task_status: anyio.abc.TaskStatus[uvicorn.Server],
) -> None:
    config = uvicorn.Config(
        app,
        http=limited_http(ConnectionLimiter(), request_within_s),
        ws=TolerantWebSocket,
        ws_max_size=4096,
        ws_per_message_deflate=False,
        ws_ping_interval=5.0,
        ws_ping_timeout=5.0,
        lifespan="off",
        log_config=None,
        # uvicorn warns of each invalid request: strangers could fill a journal.
        log_level="error",
        access_log=False,
        proxy_headers=False,
        server_header=False,
        limit_concurrency=_MAX_CONNECTIONS,
        timeout_graceful_shutdown=1,
    )
    server = _Server(config)
    task_status.started(server)
    await server.serve([listener])
