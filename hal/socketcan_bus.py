"""CAN bus of the kernel (SocketCAN): on the robot `can0`, in tests `vcan0`."""

import contextlib
import errno
import select
import socket
import struct
import time

import can
from can.interfaces.socketcan import SocketcanBus

from hal.bus_frame import BUS_FRAME, frame_of, is_heard, pack_bus_frame

_RECEIVE_BYTES = 1 << 20  # the kernel takes it twice: about 4000 frames
_FILTER = struct.Struct("=II")
_STANDARD_FRAME = 0x8000_07FF
_QUEUE_FULL = {errno.EAGAIN, errno.ENOBUFS}
_DOWN = {errno.ENETDOWN}
_GONE = {errno.ENODEV, errno.ENXIO}

# Of Linux's socket.h; Python names none of them.
_SO_RCVBUFFORCE = 33
_SO_TIMESTAMPNS = 35
_SO_RXQ_OVFL = 40
_STAMP = struct.Struct("@ll")
_COUNT = struct.Struct("@I")
_ANCILLARY_BYTES = socket.CMSG_SPACE(_STAMP.size) + socket.CMSG_SPACE(_COUNT.size)
_NS = 1e-9


class SocketCanBus(SocketcanBus):
    """One end of a SocketCAN bus.

    The kernel filters, and stamps each frame on the wall clock when it came. Own frames come back when the bus has
    carried them. An end whose interface went down or away stays lost until it is opened again, so that its silence is
    not taken for a quiet bus. Sending is still tried.
    """

    receives_own_frames = True

    def __init__(self, interface: str) -> None:
        """Open a socket on an interface. Raises OSError, can.CanError, AttributeError (a Python without CAN)."""
        super().__init__(channel=interface, receive_own_messages=True)
        self.overruns = 0
        """Frames that did not fit into the receive buffer."""
        self._heard: frozenset[int] | None = None
        self._gone: OSError | None = None
        # More than the system's limit only with privileges.
        with contextlib.suppress(PermissionError):
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BYTES)
            self.socket.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, _RECEIVE_BYTES)
        self.socket.setsockopt(socket.SOL_SOCKET, _SO_RXQ_OVFL, 1)

    def now_s(self) -> float | None:
        """Return the wall clock in s, on which the kernel stamps frames; never None."""
        return time.time()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Let the kernel deliver only frames with these standard identifiers, and error frames. Raises OSError."""
        filters = b"".join(_FILTER.pack(each, _STANDARD_FRAME) for each in sorted(frame_ids))
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, filters)
        self._heard = frame_ids  # for what waits already

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Return the oldest frame, or None after `timeout` seconds. Raises can.CanOperationError if the bus is lost."""
        return self._take() if timeout == 0 else super().recv(timeout)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Queue a frame in the kernel; `timeout` (s) is unused.

        Raises can.CanOperationError if the queue is full or the interface is lost, ValueError if it is not classic CAN.
        """
        try:
            self.socket.send(pack_bus_frame(msg), socket.MSG_DONTWAIT)
        except OSError as error:
            raise self._failure(error) from error

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if self._gone is None:
            select.select([self.socket], [], [], timeout)
        return self._take(), False

    def _take(self) -> can.Message | None:
        """Receive with one system call (python-can makes two), and tell own frames from those of other programs."""
        if self._gone is not None:
            raise self._failure(self._gone) from self._gone
        try:
            while True:
                record, ancillary, flags, _ = self.socket.recvmsg(BUS_FRAME.size, _ANCILLARY_BYTES, socket.MSG_DONTWAIT)
                frame = frame_of(*BUS_FRAME.unpack(record))
                for _, kind, data in ancillary:
                    if kind == _SO_TIMESTAMPNS:
                        seconds, nanoseconds = _STAMP.unpack(data)
                        frame.timestamp = seconds + nanoseconds * _NS
                    elif kind == _SO_RXQ_OVFL:
                        (self.overruns,) = _COUNT.unpack(data)
                if is_heard(frame, self._heard):
                    # MSG_DONTROUTE, which python-can looks at, is set on frames of any program of this machine.
                    frame.is_rx = not flags & socket.MSG_CONFIRM
                    frame.channel = self.channel
                    return frame
        except BlockingIOError:
            return None
        except OSError as error:
            raise self._failure(error) from error

    def _failure(self, error: OSError) -> can.CanOperationError:
        """Return the error with its remedy; the socket is lost with its interface."""
        if error.errno in _QUEUE_FULL:
            return can.CanOperationError("the transmit queue is full", error.errno)
        if error.errno in _DOWN:
            self._gone = error
            return can.CanOperationError(f"the interface is down: ip link set {self.channel} up", error.errno)
        if error.errno in _GONE:
            self._gone = error
            return can.CanOperationError("the interface is gone", error.errno)
        return can.CanOperationError(error.strerror or str(error), error.errno)
