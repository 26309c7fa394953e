"""TCP connections as ports that carry bytes."""

import contextlib
import errno
import fcntl
import select
import socket
import struct
import termios

from hal.bus import BusError

_MOST_BYTES = 1 << 16
_ANSWERS_WITHIN_S = 2.0
_REMEDY = "switch the robot on, check its address and the network"


class TcpPort:
    """Connection to a robot that listens at HOST:PORT (hal.byte_port.BytePort)."""

    def __init__(self, address: str) -> None:
        """Connect; wait up to 2 s. Raises hal.bus.BusError."""
        self.name = f"TCP {address}"
        host, _, port = address.rpartition(":")
        if not host or not port.isdecimal() or int(port) > 65535:
            raise BusError("is no address", where=self.name, do="give HOST:PORT, such as 192.168.1.7:7000")
        self._connected = False
        try:
            self._socket = socket.create_connection((host.strip("[]"), int(port)), timeout=_ANSWERS_WITHIN_S)
        except OSError as error:
            raise self._lost(error) from error
        # Looking a name up again would wait.
        self._peer = self._socket.getpeername()
        self._begin()

    @property
    def waiting(self) -> int:
        """Number of written bytes that the other end has not acknowledged; 0 after the connection was lost."""
        if not self._connected:
            return 0
        with contextlib.suppress(OSError):
            told = fcntl.ioctl(self._socket.fileno(), termios.TIOCOUTQ, struct.pack("i", 0))
            return int(struct.unpack("i", told)[0])
        return 0

    def read(self) -> bytes:
        """Return all bytes that arrived. Raises hal.bus.BusError."""
        self._require_connection()
        try:
            found = self._socket.recv(_MOST_BYTES)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise self._lost(error) from error
        if not found:
            raise self._lost("the robot ended the connection")
        return found

    def write(self, data: bytes) -> None:
        """Write bytes. Raises hal.bus.BusError if the connection does not take them as a whole."""
        self._require_connection()
        try:
            taken = self._socket.send(data)
        except OSError as error:
            raise self._lost(error) from error
        if taken != len(data):
            raise self._lost("takes no more bytes")

    def reopen(self) -> None:
        """Begin to connect again, or look whether that has ended; never waits.

        Raises hal.bus.BusError while the connection is lost.
        """
        if self._connected:
            self._connected = False
            self._socket.close()
        if self._socket.fileno() < 0:
            self._socket = socket.socket(self._socket.family)
            self._socket.setblocking(False)
            begun = self._socket.connect_ex(self._peer)
            if begun not in (0, errno.EINPROGRESS):
                self._give_up(begun)
        _, writable, _ = select.select((), (self._socket,), (), 0)
        if not writable:
            raise self._lost("the robot has not answered yet")
        failed = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if failed:
            self._give_up(failed)
        self._begin()

    def close(self) -> None:
        """Close the connection; may be called twice."""
        self._connected = False
        self._socket.close()

    def _begin(self) -> None:
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._connected = True

    def _give_up(self, number: int) -> None:
        """Close a connection that failed. Raises hal.bus.BusError."""
        self._socket.close()
        raise self._lost(OSError(number, errno.errorcode.get(number, "failed")))

    def _require_connection(self) -> None:
        if not self._connected:
            raise self._lost("is not connected")

    def _lost(self, cause: OSError | str) -> BusError:
        return BusError(" ".join(str(cause).split()), where=self.name, do=_REMEDY)
