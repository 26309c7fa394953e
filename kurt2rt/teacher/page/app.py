"""Web application of the page: static files, and a WebSocket between the page and the bridge."""

import mimetypes
from pathlib import Path

import anyio
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from kurt2rt.channel.protocol.schema import WireError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.auth_middleware import AuthMiddleware
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.downloads import Downloads
from kurt2rt.teacher.page.messages import parse
from kurt2rt.teacher.page.page_connection import PageConnection
from kurt2rt.teacher.page.uploads import Uploads

# Python 3.11 lacks this type, and browsers ignore a manifest with another type.
mimetypes.add_type("application/manifest+json", ".webmanifest")

STATIC = Path(__file__).parent / "static"

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013


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
