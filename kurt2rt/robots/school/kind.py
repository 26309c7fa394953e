"""The school robot as a kind of robot (simbridge.contracts.robot_kind.RobotKind)."""

import time
from pathlib import Path
from secrets import randbelow

from hal.guarded_robot import GuardedRobot
from hal.robot_settings import RobotSettings
from hal.tap import Tap, refuse_tap
from simbridge.contracts.simulation import SimulationFactory


class SchoolKind:
    """School robot on a serial port, or simulated on a line in memory."""

    settings: type[RobotSettings] = RobotSettings
    folder: Path = Path(__file__).parent / "data"

    def open(self, settings: RobotSettings, address: str, tap: Tap | None = None) -> GuardedRobot:
        """Return the driver on the serial port `address`, after the robot has greeted. A tap would see no CAN frames.

        Raises hal.bus.BusError, also for another device, config.settings.SettingsError for a tap.
        """
        from hal.byte_port import SerialPort
        from hal.linked_robot import LinkedRobot
        from kurt2rt.robots.school.lines import BIT_RATE_BIT_S, NUMBERS
        from kurt2rt.robots.school.link import SchoolLink

        refuse_tap(tap, settings.name)
        link = SchoolLink(SerialPort(address, BIT_RATE_BIT_S), len(settings.infrared.sensors), randbelow(NUMBERS))
        try:
            link.greet()
        except BaseException:
            link.close()
            raise
        return LinkedRobot(settings, link)

    def simulations(self, settings: RobotSettings) -> SimulationFactory:
        """Return the factory of simulations over a line in memory."""
        from kurt2rt.robots.school.simulated import MemoryLine
        from simbridge.simulation import LinkSimulationFactory

        return LinkSimulationFactory(settings, open_link=MemoryLine)

    def serve(self, settings: RobotSettings, address: str) -> object:
        """Return a simulated robot's end of a pseudo-terminal at the path `address`. Raises hal.bus.BusError."""
        from kurt2rt.robots.school.simulated import SchoolElectronics
        from simbridge.links import LinkRobotEnd, PtyPort

        port = PtyPort(address)
        return LinkRobotEnd(settings, port, lambda *_: SchoolElectronics(settings, port, time.monotonic))


SCHOOL = SchoolKind()
