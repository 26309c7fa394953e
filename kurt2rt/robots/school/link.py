"""Runtime's end of the school robot's line (hal.robot_link.RobotLink)."""

import math
import time
from collections.abc import Callable, Sequence

from hal.bus import BusError
from hal.byte_port import BytePort
from hal.robot import HIGHEST_COUNTS, WheelSpeeds
from hal.robot_link import ForeignCommandReport, NoticeReport, RangeReport, Report, WheelReport
from hal.sender_clock import SenderClock
from kurt2rt.robots.school import lines
from kurt2rt.robots.school.lines import Lines, difference

_HELLO_EVERY_S = 0.25
_GREETED_WITHIN_S = 10.0
"""A board that an opening resets may boot for 8 s; opening the port once more would reset it again."""
_SILENT_S = 0.5
"""A robot that sent no valid line for so long may have been switched off and on, and is greeted again."""
_TOLD_EVERY_S = 1.0
_JUNK_IN_A_ROW = 5
"""Lines within `stale_infrared_s`."""
_UNANSWERED_LINES = 50
"""Lines of a second in which no greeting was answered: the wire to the robot may be broken."""
_CLOCK_ERROR = 0.006
"""Largest error of the robot's clock, as a ratio; that of a ceramic resonator is 0.5 %."""
_SLACK_S = 0.03
"""Jitter of a line: a tick, and the 16 ms for which a USB adapter collects bytes."""
_LATEST_COMMANDS = 1000
"""Own commands, 10 s of them, among which the robot's last one has to be."""
_MOST_BEHIND = 20
"""Own commands by which the robot may be behind, 0.2 s of them: its own watchdog waits as long for the next one."""
_COMMAND_BYTES = len(lines.encode(lines.DRIVE, lines.NUMBERS - 1, 100, 100))
_FASTEST_TICKS_MS = 6
"""Three times the ticks of the robot's highest speed in 1 ms: if there were more, the counters began again."""


class SchoolLink:
    """Link that neither hears nor commands a device before it has greeted as a school robot of this version."""

    remedy = "switch the robot on, check its cable"

    def __init__(self, port: BytePort, sensors: int, first_number: int = 0) -> None:
        """Own `port`; `first_number`: of the own lines, not the same for two programs, which tells them apart."""
        self.name, self._port, self._sensors = port.name, port, sensors
        self._lines = Lines(port, first_number)
        self._last_command = first_number
        self._sent_s = [-math.inf] * 1024  # a divisor of NUMBERS, so two of the latest commands never share a place
        """Times of the latest commands, by their numbers modulo its length."""
        self._now_s = -math.inf
        self._told, self._told_at_s = "", -math.inf
        self._begin()

    def _begin(self) -> None:
        self.greeted = False
        self._hello_at_s = -math.inf
        self._heard_at_s = -math.inf
        """Time of the newest valid line, or of the first look."""
        self._strangers = 0
        """Valid lines before the greeting."""
        self._last: tuple[int, int, int] | None = None
        """Milliseconds, from any start and unbounded, and ticks of the last line."""
        self._late_lines = 0
        """Lines in a row in which the robot named an old command as the last that it obeyed."""
        self._clock = SenderClock(_CLOCK_ERROR, _SLACK_S)
        self._jumps = 0

    @property
    def junk(self) -> int:
        """Lines so far that could not be read."""
        return self._lines.junk

    @property
    def unconfirmed(self) -> int:
        """Own lines that wait to leave this machine, or lines in a row by which the robot obeys late."""
        # One alone tells nothing, and stops nothing: after a silence it names a command of before.
        return max(-(-self._port.waiting // _COMMAND_BYTES), self._late_lines)

    def receive(self, now_s: float) -> Sequence[Report]:
        """Return all reports that arrived, oldest first; `now_s` on the runtime's clock.

        Raises hal.bus.BusError for a lost line, and for a device that is no school robot of this version.
        """
        self._now_s = now_s
        reports: list[Report] = []
        messages = self._lines.read()
        if messages or self._heard_at_s == -math.inf:
            self._heard_at_s = now_s
        for word, numbers in messages:
            if word == lines.HELLO:
                self._check_greeting(numbers[1:])
            elif self.greeted:
                reports += self._reports_of(word, numbers, now_s)
            else:
                self._strangers += 1
        silent = now_s - self._heard_at_s >= _SILENT_S
        if (silent or not self.greeted) and not 0.0 <= now_s - self._hello_at_s < _HELLO_EVERY_S:
            self._hello_at_s = now_s
            self._lines.write(lines.HELLO, lines.VERSION)
        if messages or silent or self._told:
            self._tell(reports, silent=silent)
        return reports

    def greet(self, clock: Callable[[], float] = time.monotonic, sleep: Callable[[float], None] = time.sleep) -> None:
        """Wait for the greeting, up to 10 s by `clock`, before a run. Raises hal.bus.BusError."""
        ends_s = clock() + _GREETED_WITHIN_S
        while not self.greeted:
            self.receive(clock())
            if clock() > ends_s:
                raise BusError(self._ungreeted, where=self.name, do=self._ungreeted_remedy)
            sleep(0.01)

    def applied(self, speeds: WheelSpeeds) -> WheelSpeeds:
        """Return set points in m/s, towards 0 to whole mm/s."""
        return WheelSpeeds(*(_millimetres(speed) / 1000 for speed in speeds))

    def send(self, speeds: WheelSpeeds) -> None:
        """Send finite set points in m/s. Raises hal.bus.BusError."""
        if self.greeted:
            self._note_command(self._lines.write(lines.DRIVE, *map(_millimetres, speeds)))

    def brake(self) -> None:
        """Send the brake. Raises hal.bus.BusError."""
        if self.greeted:
            self._note_command(self._lines.write(lines.BRAKE))

    def forget_unconfirmed(self) -> None:
        """Let the robot's next line tell again how late it obeys; the operating system counts the bytes that wait."""
        self._late_lines = 0

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
            self._lines.count_junk()
            return []
        (_, time_ms, left, right, command), counts = numbers[:5], numbers[5:]
        last_ms, last_left, last_right = self._last or (time_ms, left, right)
        time_ms = last_ms + difference(time_ms, last_ms)
        behind = (self._last_command - command) % lines.NUMBERS
        knows = command != lines.NO_COMMAND and behind <= _LATEST_COMMANDS
        self._late_lines = self._late_lines + 1 if knows and behind > _MOST_BEHIND else 0
        answer_s = now_s - self._sent_s[command % len(self._sent_s)] if knows else math.inf
        possible = 0 <= min(counts) <= max(counts) <= HIGHEST_COUNTS
        age_s = self._clock.age_s(time_ms / 1000, now_s, answer_s) if possible else None
        if age_s is None:
            self._lines.junk += 1  # an old line again tells nothing of now
            return []
        left_ticks, right_ticks = difference(left, last_left), difference(right, last_right)
        turned = left_ticks, right_ticks, (time_ms - last_ms) / 1000
        began = self._last is None or self._jumps != self._clock.jumps
        if began or max(abs(left_ticks), abs(right_ticks)) > _FASTEST_TICKS_MS * (time_ms - last_ms):
            turned = 0, 0, 0.0
        self._last, self._jumps = (time_ms, left, right), self._clock.jumps
        at_s = now_s - age_s
        reports: list[Report] = [RangeReport(at_s, 0, counts), WheelReport(at_s, *turned)]
        if command != lines.NO_COMMAND and not knows:
            reports.append(ForeignCommandReport(at_s))
        return reports

    def _note_command(self, number: int) -> None:
        self._sent_s[number % len(self._sent_s)] = self._now_s
        self._last_command = number

    @property
    def _ungreeted(self) -> str:
        if self._strangers:
            return f"{self._strangers} lines of a school robot came, and no greeting"
        came = self._lines.trouble
        return f"no school robot answers: {came}" if came else "no school robot answers"

    @property
    def _ungreeted_remedy(self) -> str:
        came = self._strangers or self._lines.trouble
        return "check bit rate, firmware and both wires of the cable" if came else self.remedy

    def _tell(self, reports: list[Report], *, silent: bool) -> None:
        """Report what keeps readings from arriving, when it changes and at most once a second."""
        if not self.greeted and (silent or self._strangers > _UNANSWERED_LINES):
            told = f"{self._ungreeted}; {self._ungreeted_remedy}"
        elif silent or self._lines.junk_in_a_row >= _JUNK_IN_A_ROW:
            told = f"{self._lines.trouble or 'no line comes'}; {self._ungreeted_remedy}"
        else:
            told = self._clock.notice(self._now_s)
        if told != self._told and not (told and self._told and 0.0 <= self._now_s - self._told_at_s < _TOLD_EVERY_S):
            self._told, self._told_at_s = told, self._now_s
            reports.append(NoticeReport(self._now_s, told))


def _millimetres(speed_m_s: float) -> int:
    """Return a speed in whole mm/s, never faster than it was given in m/s."""
    millimetres = round(speed_m_s * 1000)
    too_fast = abs(millimetres / 1000) > abs(speed_m_s)
    return millimetres - (too_fast if millimetres > 0 else -too_fast)
