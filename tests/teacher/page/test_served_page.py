"""The page's server: access, headers, WebSocket, files, limits."""

import asyncio
import contextlib
import http.client
import io
import json
import socket
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import anyio
import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus

from kurt2rt.channel.protocol.limits import MOST_UPLOAD_BYTES
from kurt2rt.channel.security.pairing import Device
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.app import STATIC
from kurt2rt.teacher.page.device_pages import DevicePages, PageSite
from kurt2rt.teacher.page.public_address import PageError, PublicAddress
from kurt2rt.teacher.page.server import PagePort, listen
from tests.channel.jumping_loop import run_jumping
from tests.channel.missing_family import remove_family
from tests.patience import eventually
from tests.teacher.page.fake_robot import FakeRobot

TOKEN = "abcdefghijklmnopqrstuvwxyz012345"


@dataclass
class Got:
    status: int
    headers: http.client.HTTPMessage
    content: bytes

    @property
    def body(self) -> str:
        return self.content.decode()


async def ask(at: str, path: str, headers: dict[str, str] | None = None, *, content: bytes | None = None) -> Got:
    """Get a path, or post content to it, at a host and port. No thread: the time of a JumpingLoop stands meanwhile."""
    host, _, port = at.partition(":")
    reader, writer = await asyncio.open_connection(host, int(port))
    given = {"Host": at, "Connection": "close", **(headers or {})}
    if content is not None:
        given["Content-Length"] = str(len(content))
    method = "GET" if content is None else "POST"
    lines = [f"{method} {path} HTTP/1.1", *(f"{name}: {value}" for name, value in given.items())]
    writer.write("".join(f"{line}\r\n" for line in (*lines, "")).encode() + (content or b""))
    status, *head = (await reader.readuntil(b"\r\n\r\n")).split(b"\r\n")
    answer = await reader.read()
    writer.close()
    with contextlib.suppress(ConnectionError):
        await writer.wait_closed()
    return Got(int(status.split()[1]), http.client.parse_headers(io.BytesIO(b"\r\n".join(head))), answer)


@dataclass
class Served:
    robot: FakeRobot
    access: Access
    port: int
    end: anyio.Event

    @property
    def cookie(self) -> dict[str, str]:
        return {"Cookie": f"{self.access.cookie_name}={self.access.cookie}"}

    async def get(self, path: str, headers: dict[str, str] | None = None) -> Got:
        return await ask(f"127.0.0.1:{self.port}", path, headers)

    async def upload(self, content: bytes, headers: dict[str, str]) -> Got:
        return await ask(f"127.0.0.1:{self.port}", "/upload", headers, content=content)

    def websocket(self, *, origin: str | None = "same", cookie: bool = True, host: str | None = None) -> connect:
        at = f"127.0.0.1:{self.port}"
        headers = dict(self.cookie) if cookie else {}
        if origin is not None:
            headers["Origin"] = f"http://{at}" if origin == "same" else origin
        asked = f"ws://{host or at}/robot"  # names the Host; the connection goes to this server all the same
        return connect(asked, additional_headers=headers, proxy=None, host="127.0.0.1", port=self.port)


@asynccontextmanager
async def served(*, public: PublicAddress | None = None, request_within_s: float = 5.0) -> AsyncIterator[Served]:
    robot, end = FakeRobot(), anyio.Event()
    access = Access("local", TOKEN, ["desk"], public)
    site = PageSite(
        lambda _: nullcontext(cast(TeacherClient, robot)), "127.0.0.1:5683", ["desk"], "desk", public, "kurt2rt teach"
    )
    async with anyio.create_task_group() as tasks:
        pages = DevicePages(tasks, site)
        pages.serve([Device(Path("local"), "local", "127.0.0.1", 5683, TOKEN)])
        await pages.open_links()
        port = PagePort(pages, tasks, 0, request_within_s=request_within_s)
        await port.open(everywhere=False)

        async def serve() -> None:
            await end.wait()
            await pages.end()
            port.end()

        tasks.start_soon(serve)
        yield Served(robot, access, port.port, end)
        end.set()


async def hear(socket: ClientConnection, kind: str) -> dict[str, Any]:
    """Return the next message of a kind."""
    while True:
        message: dict[str, Any] = json.loads(await socket.recv())
        if message["kind"] == kind:
            return message


async def see(page: Served, socket: ClientConnection) -> int:
    """Send a state to the page; return its number."""
    await socket.send('{"kind": "beat", "picture": null, "at_ms": 0}')
    page.robot.show(teacher="local")
    number: int = (await hear(socket, "state"))["picture"]
    return number


async def test_get_without_the_cookie_is_403() -> None:
    async with served() as page:
        for path in ("/", "/index.html", "/app.js", "/style.css", "/robot", "/nothing"):
            got = await page.get(path)
            assert got.status == 403
            assert "kurt2rt teach" in got.body
            wrong = await page.get(path, {"Cookie": f"{page.access.cookie_name}={'0' * 64}"})
            assert wrong.status == 403


async def test_pair_sets_the_cookie_which_opens_the_page() -> None:
    async with served() as page:
        got = await page.get(f"/pair?token={TOKEN}")
        assert got.status == 200
        assert 'content="0;url=/"' in got.body
        cookie = got.headers["Set-Cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=strict" in cookie
        assert TOKEN not in cookie
        brought = {"Cookie": cookie.split(";")[0]}
        for path in ("/", *(f"/{file.name}" for file in STATIC.iterdir())):
            assert (await page.get(path, brought)).status == 200
        assert (await page.get("/nothing", brought)).status == 404
        assert (await page.get("/../app.py", brought)).status == 404


async def test_pair_wrong_tokens_do_not_lock_out_the_right_one() -> None:
    async with served() as page:
        for _ in range(5):
            assert (await page.get("/pair?token=guess")).status == 403
        assert (await page.get("/pair?token=guess")).status == 429
        paired = await page.get(f"/pair?token={TOKEN}")
        assert paired.status == 200
        assert page.access.cookie in paired.headers["Set-Cookie"]
        assert (await page.get("/pair?token=guess")).status == 429


async def test_get_of_a_foreign_host_is_421() -> None:
    async with served() as page:
        for path in ("/", f"/pair?token={TOKEN}"):
            assert (await page.get(path, {**page.cookie, "Host": f"evil.example:{page.port}"})).status == 421
        assert (await page.get("/", {**page.cookie, "Host": f"desk:{page.port}"})).status == 200
        with pytest.raises(InvalidStatus):
            await page.websocket(host="evil.example", origin="http://evil.example")


async def test_websocket_of_another_origin_is_refused() -> None:
    async with served() as page:
        for origin in (None, "null", "http://evil.example", "https://127.0.0.1"):
            with pytest.raises(InvalidStatus):
                await page.websocket(origin=origin)
        with pytest.raises(InvalidStatus):
            await page.websocket(cookie=False)


async def test_the_page_runs_no_foreign_script_and_is_in_no_frame() -> None:
    async with served() as page:
        got = await page.get("/", page.cookie)
        policy = got.headers["Content-Security-Policy"]
        assert "default-src 'self'" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert got.headers["X-Content-Type-Options"] == "nosniff"
        assert got.headers["Referrer-Policy"] == "no-referrer"
        assert "server" not in got.headers
        for file in STATIC.iterdir():
            if file.suffix == ".png":
                continue
            text = file.read_text(encoding="utf-8")
            assert "<script>" not in text
            assert "style=" not in text
            assert "http" not in text.replace("http://www.w3.org/", "").replace("http-equiv", ""), file.name


async def test_pictures_come_over_the_websocket_and_orders_go_back() -> None:
    async with served() as page, page.websocket() as socket:
        assert (await hear(socket, "page"))["seat"] == "here"
        number = await see(page, socket)
        order = {"kind": "command", "number": 7, "path": "/answer", "fields": {"action": "forward"}, "picture": number}
        await socket.send(json.dumps(order))
        answer = await hear(socket, "answer")
        assert (answer["number"], answer["accepted"]) == (7, True)


async def test_the_end_of_the_server_lets_go_of_the_robot_first() -> None:
    async with served() as page, page.websocket() as socket:
        number = await see(page, socket)
        press = {"kind": "press", "press_id": 1, "left_m_s": 0.2, "right_m_s": 0.2, "picture": number}
        await socket.send(json.dumps(press))
        await eventually(lambda: page.robot.told_of("press"))
        page.end.set()
        await socket.wait_closed()
        assert page.robot.told[-1] == ("let_go",)


async def test_silent_connections_do_not_keep_the_teacher_out() -> None:
    async with served() as page, AsyncExitStack() as idle:
        for _ in range(120):
            await idle.enter_async_context(await anyio.connect_tcp("127.0.0.1", page.port))
        assert (await page.get("/", page.cookie)).status == 200
        assert (await page.get(f"/pair?token={TOKEN}")).status == 200
        async with page.websocket() as socket:
            await hear(socket, "page")


@pytest.mark.parametrize(
    "said", [b"", b"GET / HTTP/1.1\r\nHost: ", b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\nhalf"]
)
def test_a_request_that_never_comes_whole_is_not_waited_for(said: bytes) -> None:
    async def story() -> None:
        async with served(request_within_s=3.0) as page, await anyio.connect_tcp("127.0.0.1", page.port) as connection:
            await connection.send(said)
            with anyio.fail_after(4.0), contextlib.suppress(anyio.EndOfStream, anyio.BrokenResourceError):
                while True:
                    await connection.receive()

    run_jumping(story)


async def test_public_address_is_served_for_a_tls_proxy() -> None:
    async with served(public=PublicAddress("robot.example")) as page:
        public = {"Host": "robot.example"}
        got = await page.get(f"/pair?token={TOKEN}", public)
        assert got.status == 200
        assert "Secure" in got.headers["Set-Cookie"]
        got = await page.get("/", {**page.cookie, **public})
        assert got.status == 200
        assert "wss://robot.example" in got.headers["Content-Security-Policy"]
        assert (await page.get("/", {**page.cookie, "Host": "evil.example"})).status == 421
        # Proxies hand on the Host, or put their own there; the Origin is the browser's.
        for host in ("robot.example", None):
            async with page.websocket(host=host, origin="https://robot.example") as socket:
                await hear(socket, "page")
        for origin in ("http://robot.example", "https://evil.example", "https://robot.example:444"):
            with pytest.raises(InvalidStatus):
                await page.websocket(host=None, origin=origin)


async def test_a_port_in_use_is_said() -> None:
    with listen(0, everywhere=False) as listener:
        port = listener.getsockname()[1]
        with pytest.raises(PageError, match=f"{port}.*--page-port"):
            listen(port, everywhere=False)


@pytest.mark.parametrize("missing", [socket.AF_INET, socket.AF_INET6])
@pytest.mark.parametrize(("sockets_open", "everywhere"), [(False, False), (False, True), (True, True)])
def test_page_listens_by_the_family_that_is_there(
    monkeypatch: pytest.MonkeyPatch, missing: socket.AddressFamily, sockets_open: bool, everywhere: bool
) -> None:
    remove_family(monkeypatch, missing, sockets_open=sockets_open)
    with listen(0, everywhere=everywhere) as listener:
        assert listener.family is not missing


COPY, COPIED = "wall-following-20261122T180000.zip", bytes(range(256)) * 20


async def test_an_upload_needs_the_cookie_and_a_page_of_ours() -> None:
    async with served() as page:
        ours = {**page.cookie, "Origin": f"http://127.0.0.1:{page.port}"}
        assert (await page.upload(b"PK", {"Origin": ours["Origin"]})).status == 403
        assert (await page.upload(b"PK", {**page.cookie, "Origin": "http://evil.example"})).status == 403
        assert not page.robot.told_of("upload")
        got = await page.upload(b"PK", ours)
        assert (got.status, len(json.loads(got.body)["upload"])) == (200, 16)
        assert (await page.upload(b"", ours)).status == 400
        large = await page.upload(bytes(MOST_UPLOAD_BYTES + 1), ours)
        assert large.status == 413
        assert "8 MB" in large.body
        assert len(page.robot.told_of("upload")) == 1


async def test_a_download_needs_the_cookie_and_a_file_of_the_robot() -> None:
    async with served() as page:
        page.robot.files[COPY] = COPIED
        assert (await page.get(f"/files/{COPY}")).status == 403
        got = await page.get(f"/files/{COPY}", page.cookie)
        assert (got.status, got.content) == (200, COPIED)
        assert got.headers["Content-Disposition"] == f"attachment; filename*=UTF-8''{COPY}"
        missing = await page.get("/files/robot.key", page.cookie)
        assert missing.status == 404
        assert missing.body
        page.robot.silent = True
        assert (await page.get(f"/files/{COPY}", page.cookie)).status == 504


async def test_invalid_message_closes_the_websocket() -> None:
    async with served() as page, page.websocket() as socket:
        await socket.send('{"kind": "drive"}')
        await socket.wait_closed()
        assert socket.close_code == 1008
