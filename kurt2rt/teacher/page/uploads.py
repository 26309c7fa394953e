"""Uploads of knowledge: received whole from the browser, sent to the robot part by part."""

import hashlib
import secrets

from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.types import Receive, Scope, Send

from kurt2rt.channel.protocol.limits import MOST_UPLOAD_BYTES, UPLOAD_ID_BYTES
from kurt2rt.core.outcome_text import Surface
from kurt2rt.teacher.client.answer import NoAnswerError, RefusedError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.texts import PageNotice, text_of


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
