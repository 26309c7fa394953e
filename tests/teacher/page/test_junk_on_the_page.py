"""Junk over the page's port leaves no traceback and keeps no teacher out: half handshakes, binary and broken frames."""

import asyncio
import base64
import contextlib
import os
import struct
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass

import anyio
import pytest

from kurt2rt.teacher.page.uvicorn_protocols import REQUEST_WITHIN_S
from tests.channel.jumping_loop import run_jumping
from tests.patience import PATIENCE_S
from tests.teacher.page.test_served_page import Served, see, served

_KEY = base64.b64encode(bytes(16)).decode()
_TEXT, _BINARY, _CLOSE, _PING, _PONG = 1, 2, 8, 9, 10


@dataclass
class Line:
    """A plain TCP connection to the page's server."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter

    async def send(self, data: bytes) -> None:
        with contextlib.suppress(ConnectionError):
            self.writer.write(data)
            await self.writer.drain()

    async def over(self) -> None:
        """Read until the server has closed it."""
        with anyio.fail_after(PATIENCE_S), contextlib.suppress(ConnectionError):
            while await self.reader.read(65_536):
                pass


@asynccontextmanager
async def line_to(page: Served) -> AsyncIterator[Line]:
    reader, writer = await asyncio.open_connection("127.0.0.1", page.port)
    try:
        yield Line(reader, writer)
    finally:
        writer.close()
        with contextlib.suppress(ConnectionError):
            await writer.wait_closed()


def handshake(page: Served, *, cookie: bool = True, **changes: str | None) -> bytes:
    headers = {
        "Host": f"127.0.0.1:{page.port}",
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Key": _KEY,
        "Sec-WebSocket-Version": "13",
        "Origin": f"http://127.0.0.1:{page.port}",
        "Cookie": page.cookie["Cookie"] if cookie else "",
    }
    given = {**headers, **{name.replace("_", "-"): value for name, value in changes.items()}}
    lines = [f"{name}: {value}" for name, value in given.items() if value is not None]
    return "\r\n".join(("GET /robot HTTP/1.1", *lines, "", "")).encode()


def frame(kind: int, payload: bytes, *, final: bool = True, masked: bool = True, reserved: int = 0) -> bytes:
    head = bytes((final << 7 | reserved << 4 | kind,))
    if len(payload) < 126:
        head += bytes((masked << 7 | len(payload),))
    else:
        head += bytes((masked << 7 | 126,)) + struct.pack(">H", len(payload))
    return head + (bytes(4) + payload if masked else payload)


FRAMES: dict[str, bytes] = {
    "binary": frame(_BINARY, b"\x00\x01"),
    "an empty binary": frame(_BINARY, b""),
    "no JSON": frame(_TEXT, b"{"),
    "empty": frame(_TEXT, b""),
    "nested": frame(_TEXT, b"[" * 4000),
    "a long number": frame(_TEXT, b"1" * 4000),
    "no map": frame(_TEXT, b"[1, 2]"),
    "no UTF-8": frame(_TEXT, b"\xff\xfe\xfd"),
    "surrogates": frame(_TEXT, b'{"kind": "\\ud800"}'),
    "not masked": frame(_TEXT, b"{}", masked=False),
    "reserved bits": frame(_TEXT, b"{}", reserved=5),
    "an unknown kind": frame(5, b"{}"),
    "a long ping": frame(_PING, bytes(200)),
    "a fragmented ping": frame(_PING, b"", final=False),
    "a pong": frame(_PONG, b"unasked") + frame(_BINARY, b""),
    "a continuation of nothing": frame(0, b"{}"),
    "two beginnings": frame(_TEXT, b"{", final=False) + frame(_TEXT, b"}"),
    "too long": bytes((0x81, 0xFF)) + struct.pack(">Q", 2**62),
    "a close of one byte": frame(_CLOSE, b"\x03"),
    "a close with a code that is none": frame(_CLOSE, struct.pack(">H", 1005)),
    "a close without UTF-8": frame(_CLOSE, struct.pack(">H", 1000) + b"\xff"),
    "frames behind a close": frame(_CLOSE, struct.pack(">H", 1000)) + frame(_TEXT, b"{}") + frame(_BINARY, b"x"),
}
HANDSHAKES: dict[str, Callable[[Served], bytes]] = {
    "half": lambda page: handshake(page)[:60],
    "without a key": lambda page: handshake(page, Sec_WebSocket_Key=None),
    "with a key that is none": lambda page: handshake(page, Sec_WebSocket_Key="%%%"),
    "with two keys": lambda page: handshake(page, Sec_WebSocket_Key=f"{_KEY}, {_KEY}"),
    "of another version": lambda page: handshake(page, Sec_WebSocket_Version="7"),
    "without an upgrade": lambda page: handshake(page, Connection="close"),
    "without a cookie": lambda page: handshake(page, cookie=False),
    "with strange extensions": lambda page: handshake(page, Sec_WebSocket_Extensions='permessage-deflate; "=;'),
    "with strange protocols": lambda page: handshake(page, Sec_WebSocket_Protocol=", ,\x01"),
    "with bytes at once": lambda page: handshake(page) + os.urandom(200),
    "with a body": lambda page: handshake(page, Content_Length="5") + b"hello",
    "by POST": lambda page: handshake(page).replace(b"GET", b"POST", 1),
    "of HTTP 1.0": lambda page: handshake(page).replace(b"HTTP/1.1", b"HTTP/1.0", 1),
}


async def still_serves(page: Served) -> None:
    async with page.websocket() as socket:
        assert await see(page, socket)


@pytest.fixture
def said(caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]) -> Callable[[], str]:
    """Return a function that reads log, tracebacks included, and output."""

    def read() -> str:
        captured = capfd.readouterr()
        return caplog.text + captured.out + captured.err

    return read


async def test_junk_frames_of_a_page_close_it_without_a_traceback(said: Callable[[], str]) -> None:
    async with served() as page:
        for what, junk in FRAMES.items():
            async with line_to(page) as line:
                await line.send(handshake(page))
                assert (await line.reader.readuntil(b"\r\n\r\n")).startswith(b"HTTP/1.1 101")
                await line.send(junk + frame(_CLOSE, struct.pack(">H", 1000)))
                await line.over()
            assert said() == "", what
        await still_serves(page)
    assert said() == ""


def test_junk_handshakes_leave_no_traceback(said: Callable[[], str]) -> None:
    async def story() -> None:
        async with served() as page:
            for what, junk in HANDSHAKES.items():
                async with line_to(page) as line:
                    await line.send(junk(page))
                    with anyio.move_on_after(0.02):
                        await line.over()
                assert said() == "", what
            await anyio.sleep(2 * REQUEST_WITHIN_S)  # those that are not complete are ended
            await still_serves(page)
        assert said() == ""

    run_jumping(story)
