"""Time of a page and its server, which stands while a test or the browser thinks.

In real time a busy machine decides: a page without a state for half a second refuses commands, and it takes back what
it says after some seconds. So the page's timers run only when the test lets time pass, and no time passes before all
messages under way between page and server have arrived.
"""

import asyncio
import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import pytest
from anyio.from_thread import BlockingPortal, start_blocking_portal
from starlette.types import Message
from starlette.websockets import WebSocket, WebSocketState

from tests.channel.jumping_loop import SteppedLoop, no_other_time

_T = TypeVar("_T")

SCRIPT = """
if (!window.passTime) {
  const [timers, sockets, sent, came] = [new Map(), [], new WeakMap(), new WeakMap()];
  const begin = Date.now();
  let [now, number, frames] = [0, 0, []];
  const add = (run, ms, again) => {
    timers.set(++number, {run, at: now + Math.max(1, ms), again});
    return number;
  };
  const cancel = (each) => timers.delete(each);
  const due = (end) => [...timers].filter(([, {at}]) => at <= end).sort(([a, x], [b, y]) => x.at - y.at || a - b)[0];
  const attempt = (run) => { try { run(); } catch (error) { reportError(error); } };
  const {setTimeout, clearTimeout, setInterval, clearInterval} = window;
  // Gives tools within the page their real time; returns what takes it from them again.
  window.realTime = () => {
    const {setTimeout: after, setInterval: each} = window;
    const pages = {setTimeout: after, clearTimeout: cancel, setInterval: each, clearInterval: cancel};
    Object.assign(window, {setTimeout, clearTimeout, setInterval, clearInterval});
    return pages;
  };
  window.setTimeout = (run, ms = 0, ...rest) => add(() => run(...rest), ms, 0);
  window.setInterval = (run, ms = 0, ...rest) => add(() => run(...rest), ms, Math.max(1, ms));
  window.clearTimeout = window.clearInterval = cancel;
  window.requestAnimationFrame = (run) => frames.push(run);
  performance.now = () => now;
  Date.now = () => begin + now;
  AbortSignal.timeout = () => new AbortController().signal;
  const Socket = WebSocket;
  window.WebSocket = class extends Socket {
    constructor(...at) {
      super(...at);
      sockets.push(this);
      sent.set(this, 0);
      came.set(this, 0);
      this.addEventListener("message", () => came.set(this, came.get(this) + 1));
    }
    send(message) {
      sent.set(this, sent.get(this) + 1);
      super.send(message);
    }
  };
  const arrival = (socket) => new Promise((done) => {
    for (const kind of ["message", "open", "close"]) socket.addEventListener(kind, done, {once: true});
    setTimeout(done, 20);
  });
  // Null while messages of the server are under way; else the number of messages to the server, -1 without a link.
  window.passTime = async (ms, told) => {
    const socket = sockets.at(-1);
    const underWay = () => socket?.readyState === Socket.OPEN && came.get(socket) < told;
    if (socket?.readyState === Socket.CONNECTING) return await arrival(socket), null;
    for (let look = 0; underWay() && look < 5; look++) await arrival(socket);
    if (underWay() || socket !== sockets.at(-1)) return null;
    const open = socket?.readyState === Socket.OPEN;
    const end = now + ms;
    for (let next; (next = due(end)); ) {
      const [each, {run, at, again}] = next;
      now = Math.max(now, at);
      if (again) timers.get(each).at = now + again;
      else cancel(each);
      attempt(run);
    }
    now = end;
    for (const run of frames.splice(0)) attempt(() => run(now));
    return open ? sent.get(socket) : -1;
  };
}
"""
_PASS = "return window.passTime ? window.passTime(...arguments) : -1;"
_UNDER_WAY_S = 60.0
"""Real seconds after which a message under way is held to be lost: a hang guard."""
_LOOK_S = 0.0005


@dataclass
class Traffic:
    """Messages of the newest page's link, as its server has seen them."""

    socket: WebSocket | None = None
    sent: int = 0
    received: int = 0

    @property
    def open(self) -> bool:
        """True while its server may hear of it."""
        return self.socket is not None and self.socket.client_state != WebSocketState.DISCONNECTED


class Phone(Protocol):
    """Browser that runs a script in its page."""

    time: "PageTime | None"

    def run(self, script: str, *arguments: object) -> Any: ...

    def leave(self) -> None: ...


class PageTime:
    """Time of a server's loop, and of the page that it serves."""

    def __init__(self, portal: BlockingPortal, loop: SteppedLoop, traffic: Traffic) -> None:
        self._portal = portal
        self._loop = loop
        self._traffic = traffic

    @contextmanager
    def shown_on(self, phone: "Phone") -> Iterator[None]:
        """Let the time of a phone's page be this one meanwhile; leave the page before the server ends."""
        phone.time = self
        try:
            yield
        finally:
            phone.leave()
            phone.time = None
            self._portal.call(self._loop.jump)

    def pass_server_time(self, seconds: float) -> None:
        """Let time pass for the server and its robot alone."""
        self._portal.call(self._loop.pass_time, seconds)

    def pass_until(self, ask: Callable[..., Awaitable[_T]], *arguments: object) -> _T:
        """Let time pass for the server and its robot until a call in their thread returns; return its result."""
        call = self._portal.start_task_soon(ask, *arguments)
        while not call.done():
            self.pass_server_time(0.01)
        return call.result()

    def pass_time(self, phone: Phone, seconds: float) -> None:
        """Let time pass for both, once all messages between them have arrived."""
        self.pass_server_time(seconds)
        sent = pass_page_time(phone, seconds, self._traffic)
        lost_s = time.monotonic() + _UNDER_WAY_S
        while self._traffic.open and self._traffic.received < sent and time.monotonic() < lost_s:
            time.sleep(_LOOK_S)
        self.pass_server_time(0.0)


def pass_page_time(phone: Phone, seconds: float, traffic: Traffic | None = None) -> int:
    """Let time pass for the page; return the number of messages that it has sent over its link, -1 without one."""
    lost_s = time.monotonic() + _UNDER_WAY_S
    while True:
        told = 0 if traffic is None or time.monotonic() > lost_s else traffic.sent
        sent = phone.run(_PASS, round(1000 * seconds), told)
        if sent is not None:
            return int(sent)
        time.sleep(_LOOK_S)


@contextmanager
def stepped_portal() -> Iterator[tuple[BlockingPortal, PageTime]]:
    """Run a loop in a thread of its own, whose time a test lets pass; count what it sends to the newest page."""
    traffic = Traffic()
    with no_other_time(), _counted(traffic):
        options = {"loop_factory": SteppedLoop}
        with start_blocking_portal("asyncio", options) as portal:
            loop = portal.call(_running_loop)
            yield portal, PageTime(portal, loop, traffic)


async def _running_loop() -> SteppedLoop:
    loop = asyncio.get_running_loop()
    assert isinstance(loop, SteppedLoop)
    return loop


@contextmanager
def _counted(traffic: Traffic) -> Iterator[None]:
    accept, send, receive = WebSocket.accept, WebSocket.send_text, WebSocket.receive

    async def counted_accept(socket: WebSocket, *arguments: Any, **options: Any) -> None:
        if "Chrome" in socket.headers.get("user-agent", ""):
            traffic.socket, traffic.sent, traffic.received = socket, 0, 0
        await accept(socket, *arguments, **options)

    async def counted_send(socket: WebSocket, data: str) -> None:
        await send(socket, data)
        if socket is traffic.socket:
            traffic.sent += 1

    async def counted_receive(socket: WebSocket) -> Message:
        message = await receive(socket)
        if socket is traffic.socket:
            traffic.received += 1
        return message

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WebSocket, "accept", counted_accept)
        patch.setattr(WebSocket, "send_text", counted_send)
        patch.setattr(WebSocket, "receive", counted_receive)
        yield
