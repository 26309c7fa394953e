"""Downloads of files that the robot wrote: fetched part by part, sent to the browser whole."""

from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import Receive, Scope, Send

from kurt2rt.teacher.client.answer import NoAnswerError, RefusedError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.texts import PageNotice, text_of

MAX_BYTES = 64_000_000
"""Limit on a file, which is in memory meanwhile. A day of 24 hours has 4 MB of lessons."""
_MEDIA_TYPES = {".zip": "application/zip", ".csv": "text/csv", ".png": "image/png"}
_DISPLAYED = ".png"
"""Ending of files that a browser displays; it saves all others."""


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
            if part.size_bytes > MAX_BYTES:
                fields = {"name": name, "size": part.size_bytes, "most": MAX_BYTES}
                raise RefusedError(text_of(PageNotice.DOWNLOAD_TOO_LARGE, **fields))
            content += part.content
        return bytes(content)


def _file(name: str, content: bytes) -> Response:
    ending = name[name.rfind(".") :]
    headers = {}
    if ending != _DISPLAYED:
        headers["Content-Disposition"] = f"attachment; filename*=UTF-8''{quote(name, safe='')}"
    return Response(content, headers=headers, media_type=_MEDIA_TYPES.get(ending, "application/octet-stream"))
