"""The live view: what is being recorded, for Foxglove over a WebSocket."""

from collections.abc import Callable

from foxglove import Context, start_server
from foxglove.websocket import WebSocketServer

LOOPBACK = "127.0.0.1"


class LiveView:
    """Shows all that is logged in a context to whoever connects. Others can look on and change nothing."""

    def __init__(
        self, context: Context, host: str, port: int, name: str, opened: Callable[["LiveView"], None] = lambda _: None
    ) -> None:
        """Opens nothing yet. `port` 0: any; `name`: what Foxglove calls it; `opened` is called when it is open."""
        self._opened = opened
        self._context = context
        self._host = host
        self._port = port
        self._name = name
        self._server: WebSocketServer | None = None
        self.trouble = ""
        """Why it is not open, in a line; empty while it is."""

    @property
    def is_open(self) -> bool:
        """Whether one can connect."""
        return self._server is not None

    @property
    def port(self) -> int:
        """The port it listens on; as it was asked for until it is open."""
        return self._port if self._server is None else self._server.port

    @property
    def address(self) -> str:
        """What one gives to Foxglove."""
        return f"ws://{self._host}:{self.port}"

    def poll(self) -> None:
        """Open it, where it is not: the port may have become free."""
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
        """Everybody is disconnected."""
        if self._server is not None:
            self._server.stop()
            self._server = None


def parse_address(text: str) -> tuple[str, int]:
    """Host and port of `PORT` or `HOST:PORT`; this machine alone unless a host is given. Raises ValueError."""
    host, colon, port = text.rpartition(":")
    if not port.isdecimal() or int(port) > 65535 or (colon and not host):
        raise ValueError(f"{text!r} is neither PORT nor HOST:PORT, with a port up to 65535")
    return host.strip("[]") or LOOPBACK, int(port)
