"""KURT2 as a plug-in: on a CAN bus, or simulated on a virtual one."""

from pathlib import Path

from config import CONFIG_DIR
from hal.guarded_robot import GuardedRobot
from hal.kurt2_settings import Kurt2Settings, require_kurt2
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from simbridge.contracts.simulation import SimulationFactory


class Kurt2Kind:
    """Kind kurt2 (simbridge.contracts.robot_kind.RobotKind): CAN driver and simulation of the paper's robot."""

    settings: type[RobotSettings] = Kurt2Settings
    folder: Path = CONFIG_DIR

    def open(self, settings: RobotSettings, address: str, tap: Tap | None = None) -> GuardedRobot:
        """Return the driver on a bus (hal.bus.open_bus). Raises BusError, CodecError, SettingsError."""
        from hal.bus import open_bus
        from hal.kurt2 import Kurt2

        checked = require_kurt2(settings, "this driver")
        bus = open_bus(address)
        bus.tap = tap
        return Kurt2(checked, bus)

    def simulations(self, settings: RobotSettings) -> SimulationFactory:
        """Return what opens simulations. Raises SettingsError."""
        from simbridge.simulation import Kurt2SimulationFactory

        return Kurt2SimulationFactory(require_kurt2(settings, "this simulation"))

    def serve(self, settings: RobotSettings, address: str) -> object:
        """Return the robot's end of a bus, for a simulated robot that other programs drive. Raises BusError."""
        from hal.bus import open_bus
        from simbridge.links import CanRobotEnd

        return CanRobotEnd(require_kurt2(settings, "this simulation"), open_bus(address))


KURT2 = Kurt2Kind()
