"""uvicorn's HTTP with patience that ends: it knows no time limit for a request that never comes."""

import asyncio
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from kurt2rt.teacher.page.connection_limiter import ConnectionLimiter

KNOWN = "kurt2rt.known"
"""In the state of an ASGI scope: to be called when its connection has shown the cookie."""

REQUEST_WITHIN_S = 5.0


def guarded_http(crowd: ConnectionLimiter, request_within_s: float = REQUEST_WITHIN_S) -> type[H11Protocol]:
    """A protocol class for uvicorn; a connection has `request_within_s` for each request, all of it."""

    class GuardedHttp(H11Protocol):
        _patience: asyncio.TimerHandle | None = None

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            self.app_state = {**self.app_state, KNOWN: lambda: crowd.leave(self)}
            crowd.enter(self, self.client[0] if self.client else "", transport.abort)
            self._be_patient()

        def connection_lost(self, exc: Exception | None) -> None:
            self._leave()
            super().connection_lost(exc)

        def data_received(self, data: bytes) -> None:
            super().data_received(data)
            # Half a request does not buy more time.
            if self.conn.their_state in (h11.IDLE, h11.SEND_BODY):
                self._be_patient()
            else:
                self._end_patience()

        def handle_websocket_upgrade(self, event: h11.Request) -> None:
            # From here on the connection is the WebSocket's, which the door closes unless it brought the cookie.
            self._leave()
            super().handle_websocket_upgrade(event)

        def _be_patient(self) -> None:
            if self._patience is None and self.transport.get_protocol() is self:
                self._patience = self.loop.call_later(request_within_s, self.transport.abort)

        def _end_patience(self) -> None:
            if self._patience is not None:
                self._patience.cancel()
                self._patience = None

        def _leave(self) -> None:
            self._end_patience()
            crowd.leave(self)

    return GuardedHttp


def shown_cookie(scope: Any) -> None:
    """Note that the connection of an ASGI scope is no stranger's."""
    known = scope.get("state", {}).get(KNOWN)
    if known is not None:
        known()
