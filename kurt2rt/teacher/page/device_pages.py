"""Pages of several devices on one port: each request goes to the device whose token or cookie it brings."""

import contextlib
import ipaddress
from collections.abc import Callable, Collection, Mapping
from contextlib import AbstractAsyncContextManager
from urllib.parse import parse_qs

import anyio
import anyio.abc
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, Device
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.app import build_app
from kurt2rt.teacher.page.auth_middleware import AuthMiddleware
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.robot_link import RobotLink

OpenLink = Callable[[Device], AbstractAsyncContextManager[RobotLink]]
"""Opens a device's link to the robot. Raises CredentialsError."""

IDLE_S = 60.0
"""A page that no browser shows for so long lets go of its pairing and of the robot's pictures."""
_LOOK_S = 0.5
_ENDING_S = 1.0


class _DevicePage:
    """The page of one device, with a link to the robot while a browser shows it."""

    def __init__(self, device: Device, access: Access, open_link: OpenLink, robot_place: str, idle_s: float) -> None:
        self.device = device
        self.access = access
        self._open_link = open_link
        self._robot_place = robot_place
        self._idle_s = idle_s
        self._app: ASGIApp | None = None
        self._closed: anyio.Event | None = None
        """Set when the link that was opened last is closed."""
        self._served = False
        """Whether the link that was opened last came to be."""
        self._ended = anyio.Event()
        self._opening = anyio.Lock()

    async def app(self, tasks: anyio.abc.TaskGroup) -> ASGIApp:
        """Return the application, its link open. Raises CredentialsError."""
        async with self._opening:
            if self._app is None:
                if self._closed is not None:
                    await self._closed.wait()  # one program, and one link in it, can use a pairing
                if self._ended.is_set():
                    raise CredentialsError("is paired no longer", where=self.device.name, do="pair it again")
                self._app = await tasks.start(self._run)
            return self._app

    def end(self) -> None:
        """Close every browser's connection and the link: the pairing is no more, or the program ends."""
        self._ended.set()

    async def closed(self) -> None:
        """Wait until no link is open, so that the robot was let go of."""
        if self._closed is not None:
            await self._closed.wait()

    async def _run(self, *, task_status: anyio.abc.TaskStatus[ASGIApp]) -> None:
        self._closed = closed = anyio.Event()
        self._served = False
        try:
            await self._serve(task_status)
        except CredentialsError:
            if not self._served:
                raise  # out of the request that wanted it
            # At the end the state could not be stored: numbers are wasted, none is used twice. The next link tells why.
        finally:
            self._app = None
            closed.set()

    async def _serve(self, task_status: anyio.abc.TaskStatus[ASGIApp]) -> None:
        async with self._open_link(self.device) as robot:
            robot.watching = False
            bridge = Bridge(robot, self.device.name, self._robot_place)
            async with anyio.create_task_group() as tasks:
                await tasks.start(bridge.run)
                self._served = True
                task_status.started(build_app(bridge, self.access, robot))
                await self._until_idle(bridge)
                bridge.dismiss()
                # A robot that does not answer lets go by itself when it hears nothing.
                with anyio.move_on_after(_ENDING_S), contextlib.suppress(NoAnswerError):
                    await bridge.end()
                tasks.cancel_scope.cancel()
        bridge.dismiss()  # a browser whose request was under way meanwhile comes again, to the next link

    async def _until_idle(self, bridge: Bridge) -> None:
        shown_s = anyio.current_time()
        while not self._ended.is_set():
            with anyio.move_on_after(min(_LOOK_S, self._idle_s)):
                await self._ended.wait()
            if bridge.visitors:
                shown_s = anyio.current_time()
            elif anyio.current_time() - shown_s >= self._idle_s:
                break
        self._app = None  # the next request opens another link, when this one is closed


class DevicePages:
    """The application in front of the pages of all devices.

    This machine's own devices are served over its loopback alone, whatever the port listens on.
    """

    def __init__(
        self,
        tasks: anyio.abc.TaskGroup,
        open_link: OpenLink,
        robot_place: str,
        names: Collection[str],
        *,
        idle_s: float = IDLE_S,
    ) -> None:
        """`tasks`: for the links; `robot_place`: where the robot should be; `names`: of this machine in an address."""
        self._tasks = tasks
        self._open_link = open_link
        self._robot_place = robot_place
        self._names = names
        self._idle_s = idle_s
        self._pages: Mapping[str, _DevicePage] = {}
        # Opened by no token: it tells strangers, also those who try tokens, what they are told anywhere.
        self._refusal = AuthMiddleware(_nothing, Access.without_device(names))

    def serve(self, devices: Collection[Device]) -> None:
        """Serve these devices from now on; who was revoked or renewed meanwhile loses every connection."""
        kept = {}
        for device in devices:
            page = self._pages.get(device.name)
            if page is None or page.device != device:
                access = Access(device.name, device.token, self._names)
                page = _DevicePage(device, access, self._open_link, self._robot_place, self._idle_s)
            kept[device.name] = page
        gone = [page for name, page in self._pages.items() if kept.get(name) is not page]
        self._pages = kept
        for page in gone:
            page.end()

    async def end(self) -> None:
        """Let go of the robot and close every connection; a robot that does not answer is not waited for."""
        pages = tuple(self._pages.values())
        self.serve(())
        for page in pages:
            await page.closed()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
        page = self._page_of(scope)
        if page is None:
            await self._refusal(scope, receive, send)
            return
        try:
            app = await page.app(self._tasks)
        except CredentialsError as error:
            await _unavailable(scope, receive, send, str(error))
            return
        await app(scope, receive, send)

    def _page_of(self, scope: Scope) -> _DevicePage | None:
        if scope["type"] not in ("http", "websocket"):
            return None
        here = is_within_this_machine(scope)
        pages = [page for name, page in self._pages.items() if here or name not in OF_THIS_MACHINE]
        if scope["path"] == "/pair":
            token = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
            return next((page for page in pages if page.access.opens(token)), None)
        cookies = HTTPConnection(scope).cookies
        return next((page for page in pages if page.access.knows(cookies)), None)


def is_within_this_machine(scope: Scope) -> bool:
    """Return whether a connection comes from this machine, and over its loopback."""
    return all(_is_loopback((scope.get(end) or ("",))[0]) for end in ("server", "client"))


def _is_loopback(address: str) -> bool:
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:
        return False
    # A socket for both kinds of addresses calls an IPv4 one ::ffff:a.b.c.d.
    mapped = parsed.ipv4_mapped if isinstance(parsed, ipaddress.IPv6Address) else None
    return (mapped or parsed).is_loopback


async def _unavailable(scope: Scope, receive: Receive, send: Send, why: str) -> None:
    if scope["type"] == "websocket":
        await receive()  # websocket.connect
        await send({"type": "websocket.close", "code": 1013, "reason": why[:100]})
    else:
        await PlainTextResponse(why, 503)(scope, receive, send)


async def _nothing(scope: Scope, receive: Receive, send: Send) -> None:
    """Serve lifespan, the one thing that a door lets through which has no key."""
