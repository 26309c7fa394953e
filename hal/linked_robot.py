"""Driver of a robot that is reached over a RobotLink."""

import math
import time
from collections.abc import Callable
from typing import Final

from hal.bus import BusError
from hal.guarded_robot import Arrivals, GuardedRobot
from hal.infrared_watch import InfraredWatch
from hal.robot import HIGHEST_COUNTS, WheelSpeeds
from hal.robot_link import AlarmReport, BumperReport, NoticeReport, RangeReport, Report, RobotLink, WheelReport
from hal.robot_settings import RobotSettings
from hal.wheel_port import WheelCommand

_BOARD = "robot"
_BRAKE: Final = object()
_LATE_S = 0.01
"""A report from later than this after the present is junk: the clocks do not agree."""
_LONGEST_FAULT = 200
"""Characters of a fault or notice that are shown, in one line."""


class LinkPort:
    """Port by which the guard sends set points over a `RobotLink` (hal.wheel_port.WheelPort)."""

    brake = _BRAKE

    def __init__(self, link: RobotLink) -> None:
        self._link = link
        self.name = link.name
        self.remedy = link.remedy

    @property
    def unconfirmed(self) -> int:
        """Own commands known to be not yet carried."""
        return self._link.unconfirmed

    def forget_unconfirmed(self) -> None:
        """Count unconfirmed commands from 0 again."""
        self._link.forget_unconfirmed()

    def command(self, speeds: WheelSpeeds) -> WheelCommand:
        """Return set points in m/s to the resolution of the link."""
        applied = self._link.applied(speeds)
        return WheelCommand(applied, applied)

    def send(self, message: object) -> None:
        """Send set points or the brake. Raises hal.bus.BusError."""
        if isinstance(message, WheelSpeeds):
            self._link.send(message)
        else:
            self._link.brake()


class LinkedRobot(GuardedRobot):
    """A robot (hal.robot.Robot) over a RobotLink, which it owns from then on.

    Its readings are as old as the oldest one of all sensors.
    """

    foreign_alarm = "another program commands the wheels; find and end it"

    def __init__(
        self, settings: RobotSettings, link: RobotLink, watchdog_clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._link: Final = link
        watch = InfraredWatch((_BOARD,), settings.guard.frozen_infrared_s)
        super().__init__(settings, LinkPort(link), watch, watchdog_clock)
        self._board, self._floor_counts = watch.board(_BOARD), settings.infrared.floor_counts
        self._times_s.extend([-math.inf] * len(self._counts))
        self._cycle_s = settings.cycle_s
        self._rejected = 0

    def _receive(self, now_s: float, arrivals: Arrivals) -> None:
        reports: tuple[Report, ...] = ()
        self._try_to_reopen(now_s)
        try:
            reports = tuple(self._link.receive(now_s))
        except BusError as error:
            self._lose_link(error, now_s)
        self._frames += len(reports)
        # Set points may change between two reports of the wheels, so the wheels respond in each tick.
        arrivals.responded_s = self._cycle_s
        for report in reports:
            if not report.at_s <= now_s + _LATE_S or not self._accept(report, min(report.at_s, now_s), arrivals):
                self._rejected += 1
        self._junk = self._rejected + self._link.junk

    def _accept(self, report: Report, at_s: float, arrivals: Arrivals) -> bool:
        """Store a report that was made at `at_s`; return False for one that this robot cannot have sent."""
        match report:
            case RangeReport(first=first, counts=counts):
                return self._store_ranges(first, counts, at_s, arrivals)
            case WheelReport(duration_s=duration_s):
                if not 0.0 <= duration_s < math.inf:
                    return False
                arrivals.left_ticks += report.left_ticks
                arrivals.right_ticks += report.right_ticks
                arrivals.turned_s += duration_s
                self._encoder_at_s = at_s
            case BumperReport(pressed=pressed):
                self._bumpers = pressed & self._bumper_mask
                arrivals.bumpers |= self._bumpers
                self._bumpers_at_s = at_s
            case AlarmReport(text=text):
                self._fault = _one_line(text) or ("no text" if text else "")
                arrivals.fault = arrivals.fault or self._fault
            case NoticeReport(text=text):
                self._notice = _one_line(text)
            case _:
                arrivals.foreign_control += 1
        return True

    def _store_ranges(self, first: int, counts: tuple[int, ...], at_s: float, arrivals: Arrivals) -> bool:
        end = first + len(counts)
        if not 0 <= first < end <= len(self._counts) or not 0 <= min(counts) <= max(counts) <= HIGHEST_COUNTS:
            return False
        if self._counts[first:end] != list(counts):
            self._counts[first:end] = counts
            self._board.still_s = 0.0
            arrivals.infrared_changed = True
        elif max(self._counts) <= self._floor_counts:
            self._board.still_s = 0.0  # with nothing in view a sensor without noise repeats itself
        self._times_s[first:end] = [at_s] * len(counts)
        return True

    def _reopen_link(self) -> None:
        self._link.reopen()
        self._forget_ages()  # it drives by what comes over this link: one that is not yet greeted takes no set point

    def _close_link(self) -> None:
        self._link.close()


def _one_line(text: str) -> str:
    return " ".join(text.split())[:_LONGEST_FAULT]
