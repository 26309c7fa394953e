"""Factory of simulated robots, with a readable error where the simulator is not installed."""

from hal.kurt2_settings import require_kurt2
from hal.robot_settings import RobotSettings
from kurt2rt.library.extras import extra_named
from kurt2rt.library.named_bus import require_bus
from simbridge.contracts.robot_kind import simulations_of
from simbridge.contracts.simulation import SimulationFactory


def open_factory(settings: RobotSettings, bus: str | None = None) -> SimulationFactory:
    """Return the factory of a robot's simulations, on a link of their own or on `bus`, for one of them at a time.

    Raises UserError (kurt2rt.Error) if the extra `simulation` is not installed, or `bus` is not for a simulated KURT2.
    """
    with extra_named():
        if bus is None:
            return simulations_of(settings)
        from simbridge.simulation import Kurt2SimulationFactory
    kurt2 = require_kurt2(settings, f"bus {bus!r}")
    require_bus(bus, kurt2)
    return Kurt2SimulationFactory(kurt2, bus=bus)
