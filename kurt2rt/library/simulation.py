"""Factory of simulated robots, with a readable error where the simulator is not installed."""

from typing import TYPE_CHECKING

from hal.errors import UserError
from hal.robot_settings import RobotSettings
from kurt2rt.library.named_bus import require_bus

if TYPE_CHECKING:
    from simbridge.simulation import Kurt2SimulationFactory

_NEEDED = ("contourpy", "matplotlib", "PIL", "pymunk", "scipy", "shapely")
"""Packages of the extra `simulation`."""


def open_factory(settings: RobotSettings, bus: str | None = None) -> "Kurt2SimulationFactory":
    """Return the factory of a robot's simulations, on a bus of their own or on `bus`, for one of them at a time.

    Raises UserError (kurt2rt.Error) if the extra `simulation` is not installed, or `bus` is not for a simulated robot.
    """
    try:
        from simbridge.simulation import Kurt2SimulationFactory
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] not in _NEEDED:
            raise
        raise UserError(
            f"{error.name} is not installed", where="simulation", do="install kurt2rt[simulation]"
        ) from error
    if bus is not None:
        require_bus(bus, settings)
    return Kurt2SimulationFactory(settings, bus=bus)
