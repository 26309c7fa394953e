"""Runtime's end of the school robot's line (hal.robot_link.RobotLink)."""

import math
import time
from collections.abc import Sequence

from hal.bus import BusError
from hal.byte_port import BytePort
from hal.robot import HIGHEST_COUNTS, WheelSpeeds
from hal.robot_link import ForeignCommandReport, RangeReport, Report, WheelReport
from kurt2rt.robots.school import lines
from kurt2rt.robots.school.lines import Lines, difference

_HELLO_EVERY_S = 0.5
_GREETED_WITHIN_S = 2.0
_CLOCK_ERROR = 0.006
"""Largest error of the robot's clock, as a ratio; that of a ceramic resonator is 0.5 %."""
_LATEST_COMMANDS = 1000
"""Own commands, 10 s of them, among which the robot's last one has to be."""


class SchoolLink:
    """Link that neither hears nor commands a device before it has greeted as a school robot of this version."""

    remedy = "switch the robot on, check its cable"

    def __init__(self, port: BytePort, sensors: int, first_number: int = 0) -> None:
        """Own `port`; `first_number`: of the own lines, not the same for two programs, which tells them apart."""
        self.name, self._port, self._sensors = port.name, port, sensors
        self._lines = Lines(port, first_number)
        self._last_command = first_number
        self._begin()

    def _begin(self) -> None:
        self.greeted = False
        self._hello_at_s = -math.inf
        self._last: tuple[int, int, int] | None = None
        """Milliseconds and ticks of the last line."""
        self._offset_s = math.inf
        """Runtime's clock minus the robot's, by the line that was on its way for the shortest time."""

    @property
    def junk(self) -> int:
        """Lines so far that could not be read."""
        return self._lines.junk

    @property
    def unconfirmed(self) -> int:
        """Own lines that wait to leave this machine."""
        return -(-self._port.waiting // len(lines.encode(lines.DRIVE, lines.NUMBERS - 1, 100, 100)))

    def receive(self, now_s: float) -> Sequence[Report]:
        """Return all reports that arrived, oldest first; `now_s` on the runtime's clock.

        Raises hal.bus.BusError for a lost line, and for a device that is no school robot of this version.
        """
        reports: list[Report] = []
        for word, numbers in self._lines.read():
            if word == lines.HELLO:
                self._check_greeting(numbers[1:])
            elif self.greeted:
                reports += self._reports_of(word, numbers, now_s)
        if not self.greeted and not 0.0 <= now_s - self._hello_at_s < _HELLO_EVERY_S:
            self._hello_at_s = now_s
            self._lines.write(lines.HELLO, lines.VERSION)
        return reports

    def greet(self) -> None:
        """Wait up to 2 s for the greeting, before a run. Raises hal.bus.BusError."""
        ends_s = time.monotonic() + _GREETED_WITHIN_S
        while not self.greeted:
            self.receive(time.monotonic())
            if time.monotonic() > ends_s:
                raise BusError("no school robot answers", where=self.name, do=self.remedy)
            time.sleep(0.01)

    def applied(self, speeds: WheelSpeeds) -> WheelSpeeds:
        """Return set points in m/s, towards 0 to whole mm/s."""
        return WheelSpeeds(*(_millimetres(speed) / 1000 for speed in speeds))

    def send(self, speeds: WheelSpeeds) -> None:
        """Send finite set points in m/s. Raises hal.bus.BusError."""
        if self.greeted:
            self._last_command = self._lines.write(lines.DRIVE, *map(_millimetres, speeds))

    def brake(self) -> None:
        """Send the brake. Raises hal.bus.BusError."""
        if self.greeted:
            self._last_command = self._lines.write(lines.BRAKE)

    def forget_unconfirmed(self) -> None:
        """Do nothing: the operating system counts the bytes that wait."""

    def reopen(self) -> None:
        """Open the line again and expect a new greeting. Raises hal.bus.BusError while it is still lost."""
        self._port.reopen()
        self._begin()

    def close(self) -> None:
        """Close the line; may be called twice."""
        self._port.close()

    def _check_greeting(self, got: tuple[int, ...]) -> None:
        allowed = (lines.VERSION, self._sensors)
        if got != allowed:
            told = f"the robot greets with version and sensors {got}, allowed is {allowed}"
            raise BusError(told, where=self.name, do="load a robot file for it, or other firmware into it")
        self.greeted = True
        self._last = None

    def _reports_of(self, word: str, numbers: tuple[int, ...], now_s: float) -> list[Report]:
        if word != lines.SENSE or len(numbers) != 5 + self._sensors:
            self._lines.junk += 1
            return []
        (number, time_ms, left, right, command), counts = numbers[:5], numbers[5:]
        last_ms, last_left, last_right = self._last or (time_ms, left, right)
        elapsed_ms = difference(time_ms, last_ms)
        begins = self._last is None or (number == 0 and elapsed_ms < 0)  # switched off and on
        if not 0 <= min(counts) <= max(counts) <= HIGHEST_COUNTS or (elapsed_ms <= 0 and not begins):
            self._lines.junk += 1  # an old line again tells nothing of now
            return []
        self._last = time_ms, left, right
        robot_s = time_ms % lines.COUNTERS / 1000
        drift_s = math.inf if begins else _CLOCK_ERROR * elapsed_ms / 1000
        self._offset_s = min(self._offset_s + drift_s, now_s - robot_s)
        at_s = robot_s + self._offset_s
        turned = (
            (0, 0, 0.0) if begins else (difference(left, last_left), difference(right, last_right), elapsed_ms / 1000)
        )
        reports: list[Report] = [RangeReport(at_s, 0, counts), WheelReport(at_s, *turned)]
        if command != lines.NO_COMMAND and (self._last_command - command) % lines.NUMBERS > _LATEST_COMMANDS:
            reports.append(ForeignCommandReport(at_s))
        return reports


def _millimetres(speed_m_s: float) -> int:
    """Return a speed in whole mm/s, never faster than it was given in m/s."""
    millimetres = round(speed_m_s * 1000)
    too_fast = abs(millimetres / 1000) > abs(speed_m_s)
    return millimetres - (too_fast if millimetres > 0 else -too_fast)
