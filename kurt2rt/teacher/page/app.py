"""The page's web application: static files, and a WebSocket between the page and the bridge."""

import mimetypes
import time
from pathlib import Path

import anyio
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from kurt2rt.channel.protocol.schema import WireError
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.auth_middleware import AuthMiddleware
from kurt2rt.teacher.page.bridge import Bridge
from kurt2rt.teacher.page.downloads import Downloads
from kurt2rt.teacher.page.messages import parse
from kurt2rt.teacher.page.page_connection import PageConnection
from kurt2rt.teacher.page.robot_link import RobotLink
from kurt2rt.teacher.page.uploads import Uploads

# Python's table of types does not know it, and a browser ignores a manifest of another type.
mimetypes.add_type("application/manifest+json", ".webmanifest")

STATIC = Path(__file__).parent / "static"

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013


def build_app(bridge: Bridge, access: Access, robot: RobotLink) -> Starlette:
    """The application for a bridge that runs, and the robot whose files it hands on."""

    async def pictures_and_orders(websocket: WebSocket) -> None:
        await _serve_page(websocket, bridge)

    return Starlette(
        routes=[
            WebSocketRoute("/robot", pictures_and_orders),
            Route("/files/{name}", Downloads(robot), methods=["GET"]),
            Route("/upload", Uploads(robot, access), methods=["POST"]),
            Mount("/", StaticFiles(directory=STATIC, html=True)),
        ],
        middleware=[Middleware(AuthMiddleware, access=access)],
    )


async def _serve_page(websocket: WebSocket, bridge: Bridge) -> None:
    await websocket.accept()
    visitor = bridge.arrive()
    try:
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(_send, websocket, visitor, tasks.cancel_scope)
            await _receive(websocket, bridge, visitor)
            tasks.cancel_scope.cancel()
    finally:
        bridge.leave(visitor)


async def _receive(websocket: WebSocket, bridge: Bridge, visitor: PageConnection) -> None:
    try:
        while True:
            bridge.hear(visitor, parse(await _text_of(websocket)))
    except WebSocketDisconnect:
        return
    except WireError as error:
        # A page of ours never says such a thing: it is another version of it, or somebody who tries things out.
        await _close(websocket, _POLICY_VIOLATION, str(error))


async def _text_of(websocket: WebSocket) -> str:
    """Return the next message. Raises WebSocketDisconnect; WireError for a binary one."""
    message = await websocket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message["code"], message.get("reason"))
    text = message.get("text")
    if text is None:
        raise WireError("this is no message of the page: it is binary")
    told: str = text
    return told


async def _send(websocket: WebSocket, visitor: PageConnection, scope: anyio.CancelScope) -> None:
    try:
        while True:
            await visitor.next()
            while (text := visitor.take(time.monotonic())) is not None:
                await websocket.send_text(text)
            if visitor.lost:
                await _close(websocket, _TRY_AGAIN_LATER, "too far behind")
                scope.cancel()
    except WebSocketDisconnect:
        scope.cancel()


async def _close(websocket: WebSocket, code: int, reason: str) -> None:
    try:
        await websocket.close(code, reason[:100])
    except (WebSocketDisconnect, RuntimeError):
        return  # it was closed from the other side at the same time
