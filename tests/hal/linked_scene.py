"""A robot over a RobotLink whose reports a test gives."""

import threading
from collections.abc import Sequence

from hal.bus import BusError
from hal.linked_robot import LinkedRobot
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from hal.robot_link import BumperReport, RangeReport, Report, WheelReport
from hal.robot_settings import RobotSettings
from tests.hal.helpers import ROBOT, SENSORS, TICK_S

SLOW = WheelSpeeds(0.1, 0.1)


class FakeLink:
    """Link whose reports a test gives."""

    name, remedy = "link of a test", "check the test"

    def __init__(self) -> None:
        self.junk = self.unconfirmed = 0
        self.asked_at_s: list[float] = []
        self.braked = threading.Event()
        self.reports: list[Report] = []
        self.sent: list[WheelSpeeds | str] = []
        self.error: BusError | None = None
        self.closed = 0
        self.reopened = 0

    def receive(self, now_s: float) -> Sequence[Report]:
        self.asked_at_s.append(now_s)
        if self.error is not None:
            raise self.error
        reports, self.reports = self.reports, []
        return reports

    def applied(self, speeds: WheelSpeeds) -> WheelSpeeds:
        return WheelSpeeds(*(int(speed * 100) / 100 for speed in speeds))

    def send(self, speeds: WheelSpeeds) -> None:
        if self.error is not None:
            raise self.error
        self.sent.append(speeds)

    def brake(self) -> None:
        if self.error is not None:
            raise self.error
        self.sent.append("brake")
        self.braked.set()

    def forget_unconfirmed(self) -> None:
        self.unconfirmed = 0

    def reopen(self) -> None:
        self.reopened += 1
        if self.error is not None:
            raise self.error

    def close(self) -> None:
        self.closed += 1


class Scene:
    """Robot, tick by tick, whose wheels obey and whose readings flicker."""

    def __init__(self, settings: RobotSettings = ROBOT) -> None:
        self.link = FakeLink()
        self.settings = settings
        self.now_s = 50.0
        self.robot = LinkedRobot(settings, self.link, lambda: self.now_s)
        self.speeds = STANDSTILL

    def hear(self, counts: int = 100) -> None:
        """Let all reports of a cycle arrive."""
        metres_per_tick = self.settings.geometry.metres_per_tick
        left, right = (round(speed * TICK_S / metres_per_tick) for speed in self.speeds)
        self.link.reports += [
            RangeReport(self.now_s, 0, (counts + round(self.now_s * 100) % 2,) * len(SENSORS)),
            WheelReport(self.now_s, left, right, TICK_S),
            BumperReport(self.now_s, 0),
        ]

    def tick(self, wanted: WheelSpeeds = SLOW, *, hears: bool = True) -> GuardResult:
        self.now_s += TICK_S
        if hears:
            self.hear()
        self.robot.sense(self.now_s)
        result = self.robot.drive(wanted, self.now_s, self.now_s)
        self.speeds = result.wheel_speeds
        return result

    def drive(self, ticks: int = 30) -> GuardResult:
        for _ in range(ticks):
            result = self.tick()
        assert result.wheel_speeds == SLOW
        return result
