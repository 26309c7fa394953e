"""Live view of a recording for Foxglove over a WebSocket."""

from collections.abc import Callable

from foxglove import Context, start_server
from foxglove.websocket import WebSocketServer

LOOPBACK = "127.0.0.1"


class LiveView:
    """Read-only server by which Foxglove shows a run live: all that is logged in a context."""

    def __init__(
        self, context: Context, host: str, port: int, name: str, opened: Callable[["LiveView"], None] = lambda _: None
    ) -> None:
        """Store the address; nothing is opened yet.

        `port` 0: any free port. `name`: title in Foxglove. `opened`: called once the server listens.
        """
        self._opened = opened
        self._context = context
        self._host = host
        self._port = port
        self._name = name
        self._server: WebSocketServer | None = None
        self.trouble = ""
        """Reason why the server is closed, in one line; empty while it listens."""

    @property
    def is_open(self) -> bool:
        """Return whether clients can connect."""
        return self._server is not None

    @property
    def port(self) -> int:
        """TCP port; the requested one until the server listens."""
        return self._port if self._server is None else self._server.port

    @property
    def address(self) -> str:
        """Address that Foxglove opens, such as ws://127.0.0.1:8765."""
        return f"ws://{self._host}:{self.port}"

    def poll(self) -> None:
        """Open the server unless it is open, because the port may have become free."""
        if self._server is not None:
            return
        try:
            # No capabilities: clients publish nothing, call nothing and set nothing.
            self._server = start_server(
                name=self._name, host=self._host, port=self._port, capabilities=[], context=self._context
            )
        except (RuntimeError, OSError, ValueError) as error:
            self.trouble = f"the live view cannot listen on {self._host}, port {self._port} ({error})"
        else:
            self.trouble = ""
            self._opened(self)

    def close(self) -> None:
        """Disconnect all clients and stop listening."""
        if self._server is not None:
            self._server.stop()
            self._server = None


def parse_address(text: str) -> tuple[str, int]:
    """Return host and port of `PORT` or `HOST:PORT`; loopback without a host. Raises ValueError."""
    host, colon, port = text.rpartition(":")
    if not port.isdecimal() or int(port) > 65535 or (colon and not host):
        raise ValueError(f"{text!r} is neither PORT nor HOST:PORT, with a port up to 65535")
    return host.strip("[]") or LOOPBACK, int(port)
