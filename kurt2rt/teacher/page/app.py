"""Web application of the page: static files, and a WebSocket between the page and the bridge."""

import hashlib
import mimetypes
import secrets
from pathlib import Path
from urllib.parse import quote

import anyio
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from kurt2rt.channel.protocol.limits import MOST_UPLOAD_BYTES, UPLOAD_ID_BYTES
from kurt2rt.core.message_fields import WireError
from kurt2rt.core.outcome_text import Surface
from kurt2rt.teacher.client.answer import NoAnswerError, RefusedError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.auth_middleware import AuthMiddleware
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.messages import parse
from kurt2rt.teacher.page.page_connection import PageConnection
from kurt2rt.teacher.page.texts import PageNotice, text_of

# Python 3.11 lacks this type, and browsers ignore a manifest with another type.
mimetypes.add_type("application/manifest+json", ".webmanifest")

STATIC = Path(__file__).parent / "static"

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013
MAX_DOWNLOAD_BYTES = 64_000_000
"""Limit on a file, which is in memory meanwhile. A day of 24 hours has 4 MB of lessons."""
_MEDIA_TYPES = {".zip": "application/zip", ".csv": "text/csv", ".png": "image/png"}
_DISPLAYED = ".png"
"""Ending of files that a browser displays; it saves all others."""


def build_app(bridge: Bridge, access: Access, robot: TeacherClient) -> Starlette:
    """Build the application of a running bridge; `robot` is the source of downloads."""

    async def serve_websocket(websocket: WebSocket) -> None:
        await _serve_page(websocket, bridge)

    return Starlette(
        routes=[
            WebSocketRoute("/robot", serve_websocket),
            Route("/files/{name}", Downloads(robot), methods=["GET"]),
            Route("/upload", Uploads(robot, access), methods=["POST"]),
            Mount("/", StaticFiles(directory=STATIC, html=True)),
        ],
        middleware=[Middleware(AuthMiddleware, access=access)],
    )


async def _serve_page(websocket: WebSocket, bridge: Bridge) -> None:
    await websocket.accept()
    connection = bridge.connect()
    try:
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(_send, websocket, connection, tasks.cancel_scope)
            await _receive(websocket, bridge, connection)
            tasks.cancel_scope.cancel()
    finally:
        bridge.disconnect(connection)


async def _receive(websocket: WebSocket, bridge: Bridge, connection: PageConnection) -> None:
    try:
        while True:
            bridge.on_message(connection, parse(await _receive_text(websocket)))
    except WebSocketDisconnect:
        return
    except WireError as error:
        # This page never sends such a message: the browser has another version of it, or is not a browser.
        await _close(websocket, _POLICY_VIOLATION, str(error))


async def _receive_text(websocket: WebSocket) -> str:
    """Return the next message. Raises WebSocketDisconnect; WireError for a binary one."""
    message = await websocket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message["code"], message.get("reason"))
    text: str | None = message.get("text")
    if text is None:
        raise WireError("a message of the page has to be text (got binary)")
    return text


async def _send(websocket: WebSocket, connection: PageConnection, scope: anyio.CancelScope) -> None:
    while True:
        await connection.wait()
        while (text := connection.pop(anyio.current_time())) is not None:
            if not await _deliver(websocket, text):
                scope.cancel()
                return
        if connection.lost:
            await _close(websocket, _TRY_AGAIN_LATER, "too far behind")
            scope.cancel()


async def _deliver(websocket: WebSocket, text: str) -> bool:
    """Send a text; return False if the connection is closed."""
    try:
        await websocket.send_text(text)
    except (WebSocketDisconnect, RuntimeError):
        return False  # the browser closed it, or this end did at the same time because of a wrong message
    return True


async def _close(websocket: WebSocket, code: int, reason: str) -> None:
    try:
        await websocket.close(code, reason[:100])
    except (WebSocketDisconnect, RuntimeError):
        return  # the browser closed it at the same time


class Uploads:
    """ASGI application for a POST of a file: its id and SHA-256 for the command `load`, or a reason in a line.

    An upload alone changes nothing: the command `load` follows over the WebSocket, from the page in control.
    """

    def __init__(self, robot: TeacherClient, access: Access) -> None:
        self._robot = robot
        self._access = access
        self._busy = False

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one ASGI request."""
        request = Request(scope, receive)
        if not self._access.is_own_origin(request.headers):
            response: Response = PlainTextResponse(text_of(PageNotice.FOREIGN_PAGE), 403)
        elif self._busy:
            response = PlainTextResponse(text_of(PageNotice.UPLOAD_BUSY), 409)
        else:
            self._busy = True
            try:
                response = await self._receive(request)
            except ClientDisconnect:
                return
            finally:
                self._busy = False
        await response(scope, receive, send)

    async def _receive(self, request: Request) -> Response:
        content = bytearray()
        async for part in request.stream():
            content += part
            if len(content) > MOST_UPLOAD_BYTES:
                most_mb = MOST_UPLOAD_BYTES // 10**6
                return PlainTextResponse(text_of(PageNotice.UPLOAD_TOO_LARGE, most_mb=most_mb), 413)
        if not content:
            return PlainTextResponse(text_of(PageNotice.UPLOAD_EMPTY), 400)
        upload = secrets.token_bytes(UPLOAD_ID_BYTES)
        try:
            await self._robot.upload(upload, bytes(content))
        except RefusedError as error:
            return PlainTextResponse(error.text_on(Surface.PAGE), 409)
        except NoAnswerError as error:
            return PlainTextResponse(str(error), 504)
        return JSONResponse({"upload": upload.hex(), "sha256": hashlib.sha256(content).hexdigest()})


class Downloads:
    """ASGI application for `/files/{name}`: 200 with the file, 404 with the robot's reason, 504 without an answer."""

    def __init__(self, robot: TeacherClient) -> None:
        self._robot = robot

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one ASGI request."""
        name = Request(scope).path_params["name"]
        try:
            response = _file(name, await self._fetch(name))
        except RefusedError as error:
            response = PlainTextResponse(f"{error}\n", 404)
        except NoAnswerError as error:
            response = PlainTextResponse(f"{error}\n", 504)
        await response(scope, receive, send)

    async def _fetch(self, name: str) -> bytes:
        content = bytearray()
        async for part in self._robot.file_parts(name):
            if part.size_bytes > MAX_DOWNLOAD_BYTES:
                fields = {"name": name, "size": part.size_bytes, "most": MAX_DOWNLOAD_BYTES}
                raise RefusedError(text_of(PageNotice.DOWNLOAD_TOO_LARGE, **fields))
            content += part.content
        return bytes(content)


def _file(name: str, content: bytes) -> Response:
    ending = name[name.rfind(".") :]
    headers = {}
    if ending != _DISPLAYED:
        headers["Content-Disposition"] = f"attachment; filename*=UTF-8''{quote(name, safe='')}"
    return Response(content, headers=headers, media_type=_MEDIA_TYPES.get(ending, "application/octet-stream"))
