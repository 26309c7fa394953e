"""Lines of the school robot: a word, the number of the line, other whole numbers, a checksum.

docs/other-robots.md#its-line-protocol lists them.
"""

import re
from binascii import crc_hqx
from itertools import count

from hal.byte_port import BytePort

VERSION = 1
BIT_RATE_BIT_S = 115_200
HELLO, SENSE, DRIVE, BRAKE = "school", "sense", "drive", "brake"
NO_COMMAND = -1
"""Number of the last command in a line of a robot that has accepted none since its greeting."""
NUMBERS = 1 << 16
"""Numbers of lines count from 0 up to this, and again from 0."""
COUNTERS = 1 << 32
"""Ticks and milliseconds do so up to this."""
_LONGEST = 160
_LINE = re.compile(rb"([a-z]+)((?: -?\d{1,10})+)\*([0-9A-F]{4})", re.ASCII)


Message = tuple[str, tuple[int, ...]]
"""Word and numbers of one valid line."""


def encode(word: str, *numbers: int) -> bytes:
    """Return the line of a word and numbers, with CRC-16/XMODEM over all that stands before the asterisk."""
    body = " ".join((word, *map(str, numbers))).encode("ascii")
    return b"%s*%04X\n" % (body, crc_hqx(body, 0))


def difference(counter: int, before: int) -> int:
    """Return the change of a counter of 32 bits that may have begun again, from -2^31 to 2^31 - 1."""
    return (counter - before + COUNTERS // 2) % COUNTERS - COUNTERS // 2


class Lines:
    """Converter between messages and lines on a port, for one end; a line ends with LF or CR LF.

    Damaged lines are counted as junk, own ones are numbered.
    """

    def __init__(self, port: BytePort, first_number: int = 0) -> None:
        self.port = port
        self.junk = 0
        self.junk_in_a_row = 0
        """Lines that could not be read since the newest valid one."""
        self._rest = b""
        self._numbers = count(first_number)

    def read(self) -> list[Message]:
        """Return the messages that have arrived as a whole. Raises hal.bus.BusError."""
        *lines, self._rest = (self._rest + self.port.read()).split(b"\n")
        if len(self._rest) > _LONGEST:
            self._rest = b""
            self.count_junk()
        messages: list[Message] = []
        for line in lines:
            match = _LINE.fullmatch(line.removesuffix(b"\r"))
            if match is None or int(match[3], 16) != crc_hqx(line[: match.end(2)], 0):
                self.count_junk()
            else:
                self.junk_in_a_row = 0
                messages.append((match[1].decode(), tuple(map(int, match[2].split()))))
        return messages

    def count_junk(self) -> None:
        """Count one line that could not be read."""
        self.junk += 1
        self.junk_in_a_row += 1

    @property
    def trouble(self) -> str:
        """Sentence about what came since the newest valid line and could not be read; empty if nothing did."""
        if self.junk_in_a_row:
            return f"{self.junk_in_a_row} lines came, none valid"
        return f"{len(self._rest)} bytes came, no whole line" if self._rest else ""

    def write(self, word: str, *numbers: int) -> int:
        """Write a line and return its number. Raises hal.bus.BusError. Callable from any thread."""
        number = next(self._numbers) % NUMBERS
        self.port.write(encode(word, number, *numbers))
        return number
