"""Factory of simulated robots, with a readable error where the simulator is not installed."""

from typing import TYPE_CHECKING

from hal.errors import UserError
from hal.robot_settings import RobotSettings

if TYPE_CHECKING:
    from simbridge.simulation import Kurt2SimulationFactory

_NEEDED = ("contourpy", "matplotlib", "networkx", "PIL", "pymunk", "shapely")
"""Packages of the extra `simulation`."""


def open_factory(settings: RobotSettings) -> "Kurt2SimulationFactory":
    """Return the factory of a robot's simulations, on a bus that loses nothing.

    Raises UserError (kurt2rt.Error) if the extra `simulation` is not installed.
    """
    try:
        from simbridge.simulation import Kurt2SimulationFactory
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] not in _NEEDED:
            raise
        raise UserError(
            f"{error.name} is not installed", where="simulation", do="install kurt2rt[simulation]"
        ) from error
    return Kurt2SimulationFactory(settings)
