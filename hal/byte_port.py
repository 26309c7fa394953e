"""Ports that carry bytes, such as serial ports, for the links of robots (hal.robot_link)."""

from collections import deque
from typing import Protocol, Self

from hal.bus import BusError


class BytePort(Protocol):
    """One end of a line that carries bytes. Nothing here waits."""

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
    """One end of a line in memory (BytePort), for a robot that is simulated in the same program."""

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
