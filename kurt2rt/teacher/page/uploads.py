"""Uploads of knowledge: taken whole from the browser, then brought to the robot part by part."""

import hashlib
import secrets

from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.types import Receive, Scope, Send

from kurt2rt.channel.protocol.requests import MOST_UPLOAD_BYTES, UPLOAD_ID_BYTES
from kurt2rt.core.outcome_text import Surface
from kurt2rt.teacher.client.answer import NoAnswerError, RefusedError
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.robot_link import RobotLink


class Uploads:
    """ASGI application for a POST of a file: its id and SHA-256 for the order `load`, or the reason why not, in a line.

    It changes nothing by itself: the order that follows over the WebSocket is the pad's.
    """

    def __init__(self, robot: RobotLink, access: Access) -> None:
        self._robot = robot
        self._access = access
        self._busy = False

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
        request = Request(scope, receive)
        if not self._access.comes_from_us(request.headers):
            response: Response = PlainTextResponse("sent by a page from elsewhere", 403)
        elif self._busy:
            response = PlainTextResponse("another file is being uploaded; wait for it", 409)
        else:
            self._busy = True
            try:
                response = await self._take(request)
            except ClientDisconnect:
                return
            finally:
                self._busy = False
        await response(scope, receive, send)

    async def _take(self, request: Request) -> Response:
        content = bytearray()
        async for part in request.stream():
            content += part
            if len(content) > MOST_UPLOAD_BYTES:
                return PlainTextResponse(f"the file is too large (at most {MOST_UPLOAD_BYTES // 10**6} MB)", 413)
        if not content:
            return PlainTextResponse("the file is empty; choose an export or a knowledge file", 400)
        upload = secrets.token_bytes(UPLOAD_ID_BYTES)
        try:
            await self._robot.upload(upload, bytes(content))
        except RefusedError as error:
            return PlainTextResponse(error.text_on(Surface.PAGE), 409)
        except NoAnswerError as error:
            return PlainTextResponse(str(error), 504)
        return JSONResponse({"upload": upload.hex(), "sha256": hashlib.sha256(content).hexdigest()})
