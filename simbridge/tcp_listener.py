"""Robot's end of a TCP connection: a simulated robot that listens, as a robot on a network does."""

import contextlib
import socket

from hal.bus import BusError

_MOST_BYTES = 1 << 16


class TcpListener:
    """Listening port (hal.byte_port.BytePort); one program at a time is connected, the newest one."""

    waiting = 0

    def __init__(self, address: str) -> None:
        """Listen at HOST:PORT; port 0: any. Raises hal.bus.BusError."""
        host, _, port = address.rpartition(":")
        try:
            self._listener = socket.create_server((host or "127.0.0.1", int(port)), backlog=1)
        except (OSError, ValueError, OverflowError) as error:
            raise BusError(
                f"cannot listen there ({error})",
                where=f"TCP {address}",
                do="give a free HOST:PORT, such as 127.0.0.1:7000",
            ) from error
        self._listener.setblocking(False)
        bound = self._listener.getsockname()
        self.address = f"{bound[0]}:{bound[1]}"
        """Address that it listens at."""
        self.name = f"TCP {self.address}"
        self._program: socket.socket | None = None

    def read(self) -> bytes:
        """Return all bytes that arrived from the program that is connected."""
        self._accept()
        if self._program is None:
            return b""
        try:
            found = self._program.recv(_MOST_BYTES)
        except BlockingIOError:
            return b""
        except OSError:
            found = b""
        if not found:
            self._hang_up()
        return found

    def write(self, data: bytes) -> None:
        """Write bytes; they are lost while no program is connected, or while it reads too slowly."""
        if self._program is not None:
            with contextlib.suppress(OSError):
                self._program.send(data)

    def reopen(self) -> None:
        """Do nothing: this end is never lost."""

    def close(self) -> None:
        """End the connection and listen no more; may be called twice."""
        self._hang_up()
        self._listener.close()

    def _accept(self) -> None:
        with contextlib.suppress(BlockingIOError):
            program, _ = self._listener.accept()
            self._hang_up()
            program.setblocking(False)
            program.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._program = program

    def _hang_up(self) -> None:
        if self._program is not None:
            self._program.close()
            self._program = None
