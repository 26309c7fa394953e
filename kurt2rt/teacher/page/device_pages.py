"""Pages of several devices on one port: each request goes to the device of its token or cookie."""

import contextlib
import secrets
from collections.abc import Callable, Collection, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from urllib.parse import parse_qs

import anyio
import anyio.abc
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, Device
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.app import build_app
from kurt2rt.teacher.page.auth_middleware import AuthMiddleware
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.host_names import is_loopback
from kurt2rt.teacher.page.public_address import PublicAddress
from kurt2rt.teacher.page.served_pages import PageAddress, page_addresses

OpenLink = Callable[[Device], AbstractAsyncContextManager[TeacherClient]]
"""Opens a device's link to the robot. Raises CredentialsError."""

IDLE_S = 60.0
"""Time without an open page after which a device's link to the robot is closed."""
_POLL_S = 0.5
_END_S = 1.0


@dataclass(frozen=True, slots=True)
class PageSite:
    """Settings shared by the pages of all devices: link to the robot, names and address of this machine."""

    open_link: OpenLink
    robot_place: str
    """Address of the robot, for texts."""
    names: Collection[str]
    """Names of this machine, as a browser may write them in an address."""
    address: str
    """Address or name of this machine for phones; auto: its addresses in its networks."""
    public: PublicAddress | None = None
    """Address at which a TLS proxy serves the pages."""
    address_command: str = "kurt2rt run --phone"
    """Command that shows the addresses, for a visitor who is not paired."""
    idle_s: float = IDLE_S

    def addresses(self, device: Device, port: int) -> tuple[PageAddress, ...]:
        """Return the addresses of a device's page on a TCP port; empty if no phone can reach this machine."""
        if self.public is not None:
            return (PageAddress(device.name, f"{self.public.origin}/pair?token={device.token}"),)
        return page_addresses(device, self.address, port)


class _DevicePage:
    """Page of one device, with a link to the robot while a browser shows the page."""

    def __init__(self, device: Device, site: PageSite) -> None:
        self.device = device
        self.access = Access(device.name, device.token, site.names, site.public)
        self._site = site
        self._app: ASGIApp | None = None
        self._closed: anyio.Event | None = None
        """Set when the newest link is closed."""
        self._served = False
        """The newest link was opened."""
        self._ended = anyio.Event()
        self._opening = anyio.Lock()

    async def app(self, tasks: anyio.abc.TaskGroup) -> ASGIApp:
        """Return the application, with an open link. Raises CredentialsError."""
        async with self._opening:
            if self._app is None:
                if self._closed is not None:
                    await self._closed.wait()  # a pairing allows one link at a time
                if self._ended.is_set():
                    raise CredentialsError("is paired no longer", where=self.device.name, do="pair it again")
                self._app = await tasks.start(self._run)
            return self._app

    def end(self) -> None:
        """Close the link and every browser's connection: the pairing or the program ends."""
        self._ended.set()

    async def closed(self) -> None:
        """Wait until no link is open."""
        if self._closed is not None:
            await self._closed.wait()

    async def _run(self, *, task_status: anyio.abc.TaskStatus[ASGIApp]) -> None:
        self._closed = closed = anyio.Event()
        self._served = False
        try:
            await self._serve(task_status)
        except CredentialsError:
            if not self._served:
                raise  # out of the request that opened the link
            # The security state could not be stored at the end: message numbers are skipped, none is used twice. The
            # next link reports the fault.
        finally:
            self._app = None
            closed.set()

    async def _serve(self, task_status: anyio.abc.TaskStatus[ASGIApp]) -> None:
        async with self._site.open_link(self.device) as robot:
            robot.watching = False
            bridge = Bridge(robot, self.device.name, self._site.robot_place)
            async with anyio.create_task_group() as tasks:
                await tasks.start(bridge.run)
                self._served = True
                task_status.started(build_app(bridge, self.access, robot))
                await self._until_idle(bridge)
                bridge.close_all()
                # A robot that does not answer stops by itself when its teacher is silent.
                with anyio.move_on_after(_END_S), contextlib.suppress(NoAnswerError):
                    await bridge.end()
                tasks.cancel_scope.cancel()
        bridge.close_all()  # a browser that connected meanwhile comes again, to the next link

    async def _until_idle(self, bridge: Bridge) -> None:
        shown_s = anyio.current_time()
        while not self._ended.is_set():
            with anyio.move_on_after(min(_POLL_S, self._site.idle_s)):
                await self._ended.wait()
            if bridge.page_count:
                shown_s = anyio.current_time()
            elif anyio.current_time() - shown_s >= self._site.idle_s:
                break
        self._app = None  # the next request opens another link after this one is closed


class DevicePages:
    """ASGI application of the pages of all devices.

    The pages of this machine's own devices are served over its loopback interface only.
    """

    def __init__(self, tasks: anyio.abc.TaskGroup, site: PageSite) -> None:
        """Serve no device yet; `tasks` runs the links."""
        self._tasks = tasks
        self._site = site
        self._pages: Mapping[str, _DevicePage] = {}
        # A visitor without a token or cookie of any device gets the refusals of this middleware.
        stranger = Access("", secrets.token_urlsafe(), site.names, site.public, address_command=site.address_command)
        self._refusal = AuthMiddleware(_no_app, stranger)

    def serve(self, devices: Collection[Device]) -> None:
        """Serve these devices from now on, and close the connections of devices that were revoked or renewed."""
        kept = {}
        for device in devices:
            page = self._pages.get(device.name)
            kept[device.name] = _DevicePage(device, self._site) if page is None or page.device != device else page
        removed = [page for name, page in self._pages.items() if kept.get(name) is not page]
        self._pages = kept
        for page in removed:
            page.end()

    async def open_links(self) -> None:
        """Open the link of each device, before a browser shows its page. Raises CredentialsError."""
        for page in self._pages.values():
            await page.app(self._tasks)

    async def end(self) -> None:
        """Close every link and connection, without waiting for a robot that does not answer."""
        pages = tuple(self._pages.values())
        self.serve(())
        for page in pages:
            await page.closed()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one ASGI request."""
        page = self._page_for(scope)
        if page is None:
            await self._refusal(scope, receive, send)
            return
        try:
            app = await page.app(self._tasks)
        except CredentialsError as error:
            await _refuse_unavailable(scope, receive, send, str(error))
            return
        await app(scope, receive, send)

    def _page_for(self, scope: Scope) -> _DevicePage | None:
        if scope["type"] not in ("http", "websocket"):
            return None
        here = is_within_this_machine(scope)
        pages = [page for name, page in self._pages.items() if here or name not in OF_THIS_MACHINE]
        if scope["path"] == "/pair":
            token = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
            return next((page for page in pages if page.access.accepts_token(token)), None)
        cookies = HTTPConnection(scope).cookies
        return next((page for page in pages if page.access.accepts_cookies(cookies)), None)


def is_within_this_machine(scope: Scope) -> bool:
    """Return whether both ends of a connection are on the loopback interface."""
    return all(is_loopback((scope.get(end) or ("",))[0]) for end in ("server", "client"))


async def _refuse_unavailable(scope: Scope, receive: Receive, send: Send, reason: str) -> None:
    if scope["type"] == "websocket":
        await receive()  # websocket.connect
        await send({"type": "websocket.close", "code": 1013, "reason": reason[:100]})
    else:
        await PlainTextResponse(reason, 503)(scope, receive, send)


async def _no_app(scope: Scope, receive: Receive, send: Send) -> None:
    """Serve lifespan, which AuthMiddleware passes on without a cookie."""
