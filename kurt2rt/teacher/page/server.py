"""Serves the page until it is told to end."""

import contextlib
import errno
import os
import socket
from collections.abc import Awaitable, Callable, Iterator

import anyio
import anyio.abc
import uvicorn
from starlette.types import ASGIApp

from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.app import build_app
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.connection_limiter import ConnectionLimiter
from kurt2rt.teacher.page.http_timeouts import REQUEST_WITHIN_S, guarded_http
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.robot_link import RobotLink
from kurt2rt.teacher.page.websocket_timeouts import GuardedWebSocket

_ENDING_S = 1.0
_MOST_CONNECTIONS = 96
"""Strangers take only a third of them."""


def listen(port: int, *, everywhere: bool, further: int = 0) -> socket.socket:
    """Return a listening TCP socket: on this machine alone, or on all its addresses. Raises PageError.

    `further`: how many ports above are tried in turn where another program has `port`.
    """
    for tried in range(port, min(port + further, 65535) + 1):
        try:
            if everywhere and socket.has_dualstack_ipv6():
                return socket.create_server(("::", tried), family=socket.AF_INET6, dualstack_ipv6=True)
            return socket.create_server(("" if everywhere else "127.0.0.1", tried))
        except OSError as error:
            why = os.strerror(error.errno or 0)  # without what create_server adds to it
            if error.errno != errno.EADDRINUSE:
                break
    raise PageError(f"port {port}: cannot listen ({why})", do="give another one with --page-port")


async def run_page(
    robot: RobotLink,
    access: Access,
    robot_place: str,
    listener: socket.socket,
    told_to_end: Callable[[], Awaitable[None]],
    *,
    request_within_s: float = REQUEST_WITHIN_S,
) -> None:
    """Serve the page of a device until `told_to_end` returns. A robot that is driven by hand then stands first.

    A connection that brings no request within `request_within_s` is closed.
    """
    robot.watching = False
    bridge = Bridge(robot, access.device, robot_place)
    async with anyio.create_task_group() as tasks:
        await tasks.start(bridge.run)
        async with anyio.create_task_group() as serving:
            app = build_app(bridge, access, robot)
            server: uvicorn.Server = await serving.start(_serve, app, listener, request_within_s)
            await told_to_end()
            # The robot lets go by itself when it hears nothing, so one that does not answer is not waited for.
            with anyio.move_on_after(_ENDING_S), contextlib.suppress(NoAnswerError):
                await bridge.end()
            server.should_exit = True
        tasks.cancel_scope.cancel()


class Doorway:
    """The one port of an application: on this machine alone, or on the network, which may change while it is served.

    Connections that are open outlast a change; between the old listening socket and the new one none is refused for
    longer than the kernel takes to open it.
    """

    def __init__(
        self,
        app: ASGIApp,
        tasks: anyio.abc.TaskGroup,
        port: int,
        *,
        further: int = 0,
        request_within_s: float = REQUEST_WITHIN_S,
    ) -> None:
        """`port`, 0: any; `further` as `listen` has it, for the first socket."""
        self._app = app
        self._tasks = tasks
        self._further = further
        self._request_within_s = request_within_s
        self._servers: list[_Server] = []
        self.port = port
        self.everywhere: bool | None = None
        """Whether the network is listened to; None before the first socket."""

    async def open(self, *, everywhere: bool) -> None:
        """Listen there, and no longer elsewhere. Raises PageError; then nothing is listened to until the next try."""
        if everywhere == self.everywhere:
            return
        for server in self._servers:
            for each in server.servers:
                each.close()
        self.everywhere = None
        listener = listen(self.port, everywhere=everywhere, further=self._further)
        self.port, self._further = listener.getsockname()[1], 0
        # Of a server before, which only waits for its last connections, nothing is left to be ended but these.
        begun: _Server = await self._tasks.start(_serve, self._app, listener, self._request_within_s)
        self._servers.append(begun)
        await begun.listening.wait()
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
        """Signals are the command's: it lets go of the robot before the server ends."""
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
        http=guarded_http(ConnectionLimiter(), request_within_s),
        ws=GuardedWebSocket,
        ws_max_size=4096,
        ws_per_message_deflate=False,
        ws_ping_interval=5.0,
        ws_ping_timeout=5.0,
        lifespan="off",
        log_config=None,
        # Junk of strangers is a warning for each: a journal would fill with it.
        log_level="error",
        access_log=False,
        proxy_headers=False,
        server_header=False,
        limit_concurrency=_MOST_CONNECTIONS,
        timeout_graceful_shutdown=1,
    )
    server = _Server(config)
    task_status.started(server)
    await server.serve([listener])
