"""The school robot passes the tests of every robot, in memory and on a pseudo-terminal."""

import time
from collections.abc import Callable

import pytest

from hal.byte_port import SerialPort
from hal.robot_link import RobotLink
from hal.robot_settings import RobotSettings
from kurt2rt.checks.plugins.robot_tests import RobotTests
from kurt2rt.robots.school.kind import SCHOOL, SchoolKind
from kurt2rt.robots.school.lines import BIT_RATE_BIT_S
from kurt2rt.robots.school.link import SchoolLink
from kurt2rt.robots.school.simulated import SchoolElectronics
from simbridge.contracts.simulation import SimulationFactory
from simbridge.links import InstantLink, PtyPort
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels
from simbridge.simulation import LinkSimulationFactory

DELIVERY_S = 0.001
"""Pause in which the kernel's own thread delivers the bytes of a cycle."""


class PtyLine(InstantLink):
    """Serial port and pseudo-terminal in simulated time (simbridge.simulation.PairedLink)."""

    def __init__(self, settings: RobotSettings) -> None:
        self._settings = settings
        self._robot_port = PtyPort()
        port = SerialPort(self._robot_port.device, BIT_RATE_BIT_S)
        self.runtime_end: RobotLink = SchoolLink(port, len(settings.infrared.sensors))

    def make_controller(self, body: Body, wheels: Wheels) -> SchoolElectronics:  # noqa: ARG002
        return SchoolElectronics(self._settings, self._robot_port)

    def cycle(self, step_robot: Callable[[], None]) -> None:
        time.sleep(DELIVERY_S)
        step_robot()
        time.sleep(DELIVERY_S)

    def close(self) -> None:
        self._robot_port.close()


class SchoolOnPty(SchoolKind):
    """School robot whose simulations use a pseudo-terminal."""

    def simulations(self, settings: RobotSettings) -> SimulationFactory:
        return LinkSimulationFactory(settings, open_link=PtyLine)


class TestSchoolRobot(RobotTests):
    kind = SCHOOL


@pytest.mark.deep
class TestSchoolRobotOnPty(RobotTests):
    kind = SchoolOnPty()
