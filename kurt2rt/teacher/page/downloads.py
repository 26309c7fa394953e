"""Downloads of files that the robot made: fetched from it part by part, handed to the browser whole."""

from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import Receive, Scope, Send

from kurt2rt.teacher.client.answer import NoAnswerError, RefusedError
from kurt2rt.teacher.page.robot_link import RobotLink

MOST_BYTES = 64_000_000
"""Of a file that is handed on: it is in memory meanwhile. A day of 24 hours has 4 MB of lessons."""
_MEDIA_TYPES = {".zip": "application/zip", ".csv": "text/csv", ".png": "image/png"}
_SHOWN = ".png"
"""Shown by a browser; files with any other ending are stored."""


class Downloads:
    """ASGI application for `/files/{name}`: 200 with the file, 404 with the robot's reason, 504 without an answer."""

    def __init__(self, robot: RobotLink) -> None:
        self._robot = robot

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
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
            if part.size_bytes > MOST_BYTES:
                raise RefusedError(f"{name}: {part.size_bytes} bytes are too many (at most {MOST_BYTES})")
            content += part.content
        return bytes(content)


def _file(name: str, content: bytes) -> Response:
    ending = name[name.rfind(".") :]
    headers = {}
    if ending != _SHOWN:
        headers["Content-Disposition"] = f"attachment; filename*=UTF-8''{quote(name, safe='')}"
    return Response(content, headers=headers, media_type=_MEDIA_TYPES.get(ending, "application/octet-stream"))
