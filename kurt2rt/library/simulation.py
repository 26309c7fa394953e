"""Factory of simulated robots, with a readable error where the simulator is not installed."""

from typing import TYPE_CHECKING

from hal.robot_settings import RobotSettings
from kurt2rt.library.extras import extra_named
from kurt2rt.library.named_bus import require_bus

if TYPE_CHECKING:
    from simbridge.simulation import Kurt2SimulationFactory


def open_factory(settings: RobotSettings, bus: str | None = None) -> "Kurt2SimulationFactory":
    """Return the factory of a robot's simulations, on a bus of their own or on `bus`, for one of them at a time.

    Raises UserError (kurt2rt.Error) if the extra `simulation` is not installed, or `bus` is not for a simulated robot.
    """
    with extra_named():
        from simbridge.simulation import Kurt2SimulationFactory
    if bus is not None:
        require_bus(bus, settings)
    return Kurt2SimulationFactory(settings, bus=bus)
