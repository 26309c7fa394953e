"""uvicorn's WebSocket protocol, which answers text that is no UTF-8 with a traceback."""

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol


class GuardedWebSocket(WebSocketsSansIOProtocol):
    """Hand text that is no UTF-8 to the application as bytes, which it refuses as any binary message.

    uvicorn 0.54 logs a traceback for it, and fails in the event loop if the other side closes at the same time.
    """

    def send_receive_event_to_app(self) -> None:
        """Queue a whole message for the application."""
        try:
            b"".join(self.frames).decode()
        except UnicodeDecodeError:
            self.curr_msg_data_type = "bytes"
        super().send_receive_event_to_app()
