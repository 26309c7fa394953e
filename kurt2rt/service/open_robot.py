"""Composition root: the only place that knows whether the robot is simulated or real."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import NamedTuple, Protocol

from hal.guarded_robot import GuardedRobot
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from kurt2rt.platform.simulated_clock import HeldWorld
from kurt2rt.service.bus_names import SIMULATED
from simbridge.contracts.robot_kind import kind_of
from simbridge.contracts.simulation import SimulatedWorld, Simulation


class OpenedRobot(NamedTuple):
    """Open robot to be driven, with the simulator's parts that the program needs if it is simulated."""

    robot: GuardedRobot
    simulated_world: SimulatedWorld | None
    is_alive: Callable[[], bool]
    """Returns whether the simulator still runs; always true for a real robot."""
    held_world: HeldWorld | None = None
    """World of a simulated robot whose time may pass faster than real time."""
    simulation: Simulation | None = None
    """Simulation with the true pose, for metrics; None for a real robot."""
    require_world: Callable[[str], None] | None = None
    """Raises SettingsError unless the simulator can load the world of that name; None for a real robot."""


class RobotOpener(Protocol):
    """Function that opens the robot of the settings, real or simulated; `open_robot` is one."""

    def __call__(
        self, settings: RobotSettings, bus: str, world: str, seed: int, tap: Tap | None = None
    ) -> AbstractContextManager[OpenedRobot]:
        """Return a context manager that opens the robot on a bus. Raises BusError, SettingsError."""
        ...


@contextmanager
def open_robot(
    settings: RobotSettings, bus: str, world: str, seed: int, tap: Tap | None = None
) -> Iterator[OpenedRobot]:
    """Open the robot for a run in real time, with its watchdog: the simulated robot for `sim`, else the one on `bus`.

    `world` and `seed` are the simulated robot's. `tap` sees each frame at the runtime's end of the bus.

    Raises BusError, CodecError and SettingsError, and at the end the error that ended the simulation.
    """
    kind = kind_of(settings)
    if bus == SIMULATED:
        simulations = kind.simulations(settings)
        with simulations.live(world, seed, tap) as live:
            yield OpenedRobot(
                live.robot,
                live.world,
                lambda: live.world.lives,
                live.world.held_world,
                live.simulation,
                simulations.require_worlds,
            )
        return
    robot = kind.open(settings, bus, tap)
    try:
        with robot.watchdog:
            yield OpenedRobot(robot, None, lambda: True)
    finally:
        robot.close()
