"""Protocols of uvicorn with limits that uvicorn itself lacks: a time limit for requests, junk in a WebSocket."""

import asyncio
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol


class ConnectionLimiter:
    """Limit on connections that have not shown a cookie: `most` in all, and `per_address` of one address."""

    def __init__(self, most: int = 32, per_address: int = 12) -> None:
        self._most = most
        self._per_address = per_address
        self._waiting: OrderedDict[object, tuple[str, Callable[[], None]]] = OrderedDict()

    def add(self, connection: object, address: str, close: Callable[[], None]) -> None:
        """Add a connection of an address, and close the oldest one (of that address) if there are too many."""
        same = [each for each, (its, _) in self._waiting.items() if its == address]
        if len(same) >= self._per_address:
            self._evict(same[0])
        elif len(self._waiting) >= self._most:
            self._evict(next(iter(self._waiting)))
        self._waiting[connection] = (address, close)

    def remove(self, connection: object) -> None:
        """Stop counting a connection: it has shown the cookie, or was closed."""
        self._waiting.pop(connection, None)

    def __len__(self) -> int:
        return len(self._waiting)

    def _evict(self, connection: object) -> None:
        _, close = self._waiting.pop(connection)
        close()


AUTHENTICATED = "kurt2rt.known"
"""Key in the state of an ASGI scope: callback for a connection that has shown the cookie."""

REQUEST_WITHIN_S = 5.0


def limited_http(limiter: ConnectionLimiter, request_within_s: float = REQUEST_WITHIN_S) -> type[H11Protocol]:
    """Return a protocol class for uvicorn that closes a connection without a whole request in `request_within_s`."""

    class LimitedHttp(H11Protocol):
        _timeout: asyncio.TimerHandle | None = None

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            self.app_state = {**self.app_state, AUTHENTICATED: lambda: limiter.remove(self)}
            limiter.add(self, self.client[0] if self.client else "", transport.abort)
            self._start_timeout()

        def connection_lost(self, exc: Exception | None) -> None:
            self._remove()
            super().connection_lost(exc)

        def data_received(self, data: bytes) -> None:
            super().data_received(data)
            # A part of a request does not extend the limit.
            if self.conn.their_state in (h11.IDLE, h11.SEND_BODY):
                self._start_timeout()
            else:
                self._end_timeout()

        def handle_websocket_upgrade(self, event: h11.Request) -> None:
            # From here on AuthMiddleware closes a WebSocket without the cookie.
            self._remove()
            super().handle_websocket_upgrade(event)

        def _start_timeout(self) -> None:
            if self._timeout is None and self.transport.get_protocol() is self:
                self._timeout = self.loop.call_later(request_within_s, self.transport.abort)

        def _end_timeout(self) -> None:
            if self._timeout is not None:
                self._timeout.cancel()
                self._timeout = None

        def _remove(self) -> None:
            self._end_timeout()
            limiter.remove(self)

    return LimitedHttp


def mark_authenticated(scope: Any) -> None:
    """Exempt the connection of an ASGI scope from the limit on unauthenticated connections."""
    callback = scope.get("state", {}).get(AUTHENTICATED)
    if callback is not None:
        callback()


class TolerantWebSocket(WebSocketsSansIOProtocol):
    """WebSocket protocol that passes text without valid UTF-8 on as bytes, which the application refuses.

    uvicorn 0.54 logs a traceback for such text, and fails in the event loop if the peer closes at the same time.
    """

    def send_receive_event_to_app(self) -> None:
        """Queue a whole message for the application."""
        try:
            b"".join(self.frames).decode()
        except UnicodeDecodeError:
            self.curr_msg_data_type = "bytes"
        super().send_receive_event_to_app()
