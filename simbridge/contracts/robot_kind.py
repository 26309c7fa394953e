"""Kind of robot: schema of its settings, driver and simulation, which a plug-in of `kurt2rt.robots` offers."""

from pathlib import Path
from typing import Protocol, cast

from config.robot_plugins import find_robot_kind
from hal.guarded_robot import GuardedRobot
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from simbridge.contracts.simulation import SimulationFactory


class RobotKind(Protocol):
    """Kind of robot, as a plug-in of `kurt2rt.robots` offers it: schema of its settings, driver and simulation.

    Importing it is light: a driver imports its packages in `open`, a simulation in `simulations`. Shipped are kurt2,
    school and turtlebot; `kind:` in a robot's settings names one.
    """

    @property
    def settings(self) -> type[RobotSettings]:
        """Schema of the settings of such a robot."""
        ...

    @property
    def folder(self) -> Path:
        """Folder of its YAML files, with the folders of `config`: robots, situations, repertoires, tasks, worlds."""
        ...

    def open(self, settings: RobotSettings, address: str, tap: Tap | None = None) -> GuardedRobot:
        """Return the driver of the robot at an address, such as can0; its watchdog is not started.

        `tap`: sees each CAN frame; a kind without CAN refuses one. Raises hal.bus.BusError, SettingsError.
        """
        ...

    def simulations(self, settings: RobotSettings) -> SimulationFactory:
        """Return what opens simulations of such a robot."""
        ...

    def serve(self, settings: RobotSettings, address: str) -> object:
        """Return the end of the link at which a simulated robot is (simbridge.links.RobotEnd), for other programs.

        Raises hal.bus.BusError if the address cannot be opened or a robot is there.
        """
        ...


def kind_of(settings: RobotSettings) -> RobotKind:
    """Return the kind of a robot. Raises config.settings.SettingsError if its plug-in is not installed."""
    return cast("RobotKind", find_robot_kind(settings.kind))


def simulations_of(settings: RobotSettings) -> SimulationFactory:
    """Return what opens simulations of a robot. Raises SettingsError.

    Raises ModuleNotFoundError where the simulator, which is an extra, is not installed.
    """
    return kind_of(settings).simulations(settings)
