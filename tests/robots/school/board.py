"""Board of the school robot in virtual time: it boots, loses lines, ends them with CR LF, or sends what is none."""

from hal.byte_port import BytePort, MemoryPort
from kurt2rt.robots.school import lines
from kurt2rt.robots.school.lines import COUNTERS, Lines, difference
from kurt2rt.robots.school.link import SchoolLink

SENSORS = 7
TICK_MS = 10


class Board:
    """Robot's end of a line in memory, and the runtime's link at the other end; both step by 10 ms."""

    def __init__(self, *, boots_for_ms: int = 0, uptime_ms: int = 0, ending: bytes = b"\n") -> None:
        """`uptime_ms`: time for which it has run; 0: it is reset now, and boots for `boots_for_ms`."""
        port, self._port = MemoryPort.pair()
        self.link = SchoolLink(port, SENSORS, first_number=10)
        self._ending = ending
        self.now_ms = 0
        self.ticks_ms = 0
        """Ticks that both wheels turn in 1 ms."""
        self.garbage = b""
        """Bytes in place of each line; empty: lines."""
        self.first_line_ms = -1
        """Time of the first line since the newest reset that was not lost."""
        self.reset(boots_for_ms)
        self._booted_ms -= uptime_ms

    @property
    def now_s(self) -> float:
        return self.now_ms / 1000

    def reset(self, boots_for_ms: int = 0, *, loses_lines: int = 0) -> None:
        """Switch it off and on; the runtime does not get its first `loses_lines` lines."""
        self._booted_ms = self.now_ms + boots_for_ms
        self._losing = loses_lines
        self._ticks, self._command, self.first_line_ms = 0, lines.NO_COMMAND, -1
        self._lines = Lines(_Ending(self._port, self._ending))

    def step(self) -> None:
        """Let 10 ms pass at the board."""
        self.now_ms += TICK_MS
        uptime_ms = self.now_ms - self._booted_ms
        if uptime_ms <= 0:
            self._port.read()
            return
        self._ticks += self.ticks_ms * TICK_MS
        for word, numbers in self._lines.read():
            if word == lines.HELLO:
                self._send(lines.HELLO, lines.VERSION, SENSORS)
            else:
                self._command = numbers[0]
        if self.now_ms % 20 == 0:
            self._send(lines.SENSE, uptime_ms % COUNTERS, difference(self._ticks, 0), 0, self._command, *(9,) * SENSORS)

    def _send(self, word: str, *numbers: int) -> None:
        if self._losing > 0:
            self._losing -= 1
            next(self._lines._numbers)
        elif self.garbage:
            self._port.write(self.garbage)
        else:
            self.first_line_ms = self.now_ms if self.first_line_ms < 0 else self.first_line_ms
            self._lines.write(word, *numbers)


class _Ending:
    """Port that ends lines in its own way."""

    def __init__(self, port: BytePort, ending: bytes) -> None:
        self._port, self._ending, self.name = port, ending, port.name
        self.read, self.reopen, self.close, self.waiting = port.read, port.reopen, port.close, 0

    def write(self, data: bytes) -> None:
        self._port.write(data[:-1] + self._ending)
