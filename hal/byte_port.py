"""Ports that carry bytes, such as serial ports, for the links of robots (hal.robot_link)."""

import contextlib
from collections import deque
from typing import Protocol, Self

import serial

from hal.bus import BusError


class BytePort(Protocol):
    """One end of a line that carries bytes, such as a serial port, for the link of a robot. Nothing here waits.

    A link owns one; `MemoryPort.pair()` is a line for a simulated robot in the same program.
    """

    name: str

    @property
    def waiting(self) -> int:
        """Number of written bytes that have not left yet; 0 if the port does not tell."""
        ...

    def read(self) -> bytes:
        """Return all bytes that arrived. Raises hal.bus.BusError while the line is lost."""
        ...

    def write(self, data: bytes) -> None:
        """Write bytes. Raises hal.bus.BusError if they are not taken as a whole. Callable from any thread."""
        ...

    def reopen(self) -> None:
        """Open the line again. Raises hal.bus.BusError while it is still lost."""
        ...

    def close(self) -> None:
        """Close the line; may be called twice."""
        ...


class MemoryPort:
    """End of a line in memory (BytePort) to a robot that this program simulates; `pair` makes both ends."""

    waiting = 0

    def __init__(self, name: str, inward: deque[bytes], outward: deque[bytes]) -> None:
        self.name = name
        self.lost = False
        """Whether the line is lost; a fault for tests."""
        self._inward, self._outward = inward, outward

    @classmethod
    def pair(cls) -> tuple[Self, Self]:
        """Return both ends of a line."""
        one: deque[bytes] = deque()
        other: deque[bytes] = deque()
        return cls("line in memory", one, other), cls("line in memory, far end", other, one)

    def read(self) -> bytes:
        """Return all bytes that arrived. Raises hal.bus.BusError while the line is lost."""
        self.reopen()
        return b"".join(self._inward.popleft() for _ in range(len(self._inward)))

    def write(self, data: bytes) -> None:
        """Write bytes. Raises hal.bus.BusError while the line is lost."""
        self.reopen()
        self._outward.append(data)

    def reopen(self) -> None:
        """Check the line. Raises hal.bus.BusError while it is lost."""
        if self.lost:
            raise BusError("the line is lost", where=self.name, do="mend it")

    def close(self) -> None:
        """Do nothing: the line is in memory."""


_REMEDY = "plug the robot in, check the name of the port and the permission to use it"
_MOST_BYTES = 1 << 16


class SerialPort:
    """Serial port by the path of its device (hal.byte_port.BytePort), which no other program may open."""

    def __init__(self, device: str, bit_rate_bit_s: int) -> None:
        """Open the port; bytes that came before are dropped. Raises hal.bus.BusError."""
        self.name = f"serial port {device}"
        self._device = device
        self._bit_rate_bit_s = bit_rate_bit_s
        self._serial = self._open()

    @property
    def waiting(self) -> int:
        """Number of written bytes that have not left yet; 0 after the port was lost."""
        with contextlib.suppress(OSError):
            return int(self._serial.out_waiting)
        return 0

    def read(self) -> bytes:
        """Return all bytes that arrived. Raises hal.bus.BusError."""
        try:
            return bytes(self._serial.read(_MOST_BYTES))
        except OSError as error:
            raise self._lost(error) from error

    def write(self, data: bytes) -> None:
        """Write bytes. Raises hal.bus.BusError if the port does not take them as a whole."""
        try:
            taken = self._serial.write(data)
        except OSError as error:
            raise self._lost(error) from error
        if taken != len(data):
            raise BusError("takes no more bytes", where=self.name, do=_REMEDY)

    def reopen(self) -> None:
        """Open the port again. Raises hal.bus.BusError while it is still lost."""
        self.close()
        self._serial = self._open()

    def close(self) -> None:
        """Close the port; may be called twice."""
        self._serial.close()

    def _open(self) -> serial.Serial:
        try:
            # Timeouts of 0: nothing waits.
            return serial.Serial(self._device, self._bit_rate_bit_s, timeout=0, write_timeout=0, exclusive=True)
        except OSError as error:
            raise self._lost(error) from error

    def _lost(self, error: OSError) -> BusError:
        return BusError(" ".join(str(error).split()), where=self.name, do=_REMEDY)
