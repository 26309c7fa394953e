"""Middleware that checks each request's host, pairing and origin, and sets the security headers of each answer."""

import time
from collections import OrderedDict
from collections.abc import Callable

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.public_address import PublicAddress
from kurt2rt.teacher.page.texts import PageNotice, text_of
from kurt2rt.teacher.page.uvicorn_protocols import mark_authenticated

_LONGEST_COOKIE_S = 90 * 24 * 3600

_SCAN_AGAIN = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>kurt2rt</title></head>
<body><h1>Scan the code again</h1>
<p>This browser is not paired with the robot, or no longer.</p>
<p>Open the address that <code>{command}</code> shows, or scan its code.</p></body></html>
"""
# A page, not a redirect: a browser that followed a link of another site would come without the SameSite cookie.
_WELCOME = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="0;url=/">
<link rel="icon" href="/icon.svg" type="image/svg+xml">
<title>kurt2rt</title></head>
<body><p><a href="/">Go on to the robot</a></p></body></html>
"""


class LoginThrottle:
    """Limit on wrong tokens of an address: a token bucket of tries. Times are seconds of a monotonic clock."""

    def __init__(self, most: int = 5, per_s: float = 0.2, addresses: int = 256) -> None:
        """Allow `most` tries at once, then `per_s`; store only the last `addresses`, which bounds the memory."""
        self._most = most
        self._per_s = per_s
        self._addresses = addresses
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def is_allowed(self, address: str, now_s: float) -> bool:
        """Return whether an address may try now; this does not count as a try."""
        return self._tries_left(address, now_s) >= 1.0

    def on_failure(self, address: str, now_s: float) -> None:
        """Count a wrong token from an address at `now_s`."""
        self._left[address] = (self._tries_left(address, now_s) - 1.0, now_s)
        self._left.move_to_end(address)
        if len(self._left) > self._addresses:
            self._left.popitem(last=False)

    def _tries_left(self, address: str, now_s: float) -> float:
        left, counted_s = self._left.get(address, (float(self._most), now_s))
        return min(float(self._most), left + (now_s - counted_s) * self._per_s)


class AuthMiddleware:
    """ASGI middleware of one device: it checks the host, then the pairing, then the origin of a WebSocket."""

    def __init__(self, app: ASGIApp, access: Access, *, now: Callable[[], float] = time.monotonic) -> None:
        self._app = app
        self._access = access
        self._throttle = LoginThrottle()
        self._now = now

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one ASGI request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        send = _with_security_headers(send, headers.get("host", ""), self._access.public)
        local_address = (scope.get("server") or ("", None))[0]
        if not self._access.is_own_host(headers, local_address):
            refusal: Response = PlainTextResponse(text_of(PageNotice.FOREIGN_HOST), 421)
        elif scope["type"] == "http" and scope["path"] == "/pair":
            refusal = self._pair(HTTPConnection(scope))
        elif not self._access.accepts_cookies(HTTPConnection(scope).cookies):
            refusal = self._scan_again(403)
        elif scope["type"] == "websocket" and not self._access.is_own_origin(headers):
            refusal = PlainTextResponse(text_of(PageNotice.FOREIGN_PAGE), 403)
        else:
            mark_authenticated(scope)
            await self._app(scope, receive, send)
            return
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": ""})
        else:
            await refusal(scope, receive, send)

    def _pair(self, request: HTTPConnection) -> Response:
        address = request.client.host if request.client else ""
        # The right token is checked before the throttle: other users of this address, such as a proxy's, must not lock
        # out the teacher. A token has 192 random bits, so it cannot be guessed.
        if not self._access.accepts_token(request.query_params.get("token", "")):
            if not self._throttle.is_allowed(address, self._now()):
                return PlainTextResponse(text_of(PageNotice.TOO_MANY_TOKENS), 429)
            self._throttle.on_failure(address, self._now())
            return self._scan_again(403)
        response = HTMLResponse(_WELCOME)
        response.set_cookie(
            self._access.cookie_name,
            self._access.cookie,
            max_age=_LONGEST_COOKIE_S,
            httponly=True,
            samesite="strict",
            secure=self._access.is_public(request.headers),
        )
        return response

    def _scan_again(self, status: int) -> Response:
        return HTMLResponse(_SCAN_AGAIN.format(command=self._access.address_command), status)


def _with_security_headers(send: Send, host: str, public: PublicAddress | None) -> Send:
    sockets = f"ws://{host}" if public is None else f"ws://{host} wss://{public.place}"
    policy = f"default-src 'self'; connect-src 'self' {sockets}; frame-ancestors 'none'; base-uri 'none'"

    async def send_on(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers["Content-Security-Policy"] = f"{policy}; form-action 'none'; object-src 'none'"
            headers["X-Content-Type-Options"] = "nosniff"
            headers["X-Frame-Options"] = "DENY"
            headers["Referrer-Policy"] = "no-referrer"
            headers["Cross-Origin-Opener-Policy"] = "same-origin"
            headers["Cross-Origin-Resource-Policy"] = "same-origin"
            headers["Cache-Control"] = "no-cache"
        await send(message)

    return send_on
