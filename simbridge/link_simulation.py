"""Simulations of a robot that is reached over a RobotLink, for plug-ins."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Protocol

from hal.linked_robot import LinkedRobot
from hal.robot_link import RobotLink
from hal.robot_settings import RobotSettings
from hal.tap import Tap, refuse_tap
from simbridge.contracts.simulation import LiveSimulation
from simbridge.controller.controller import Controller
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels
from simbridge.robot_simulation import RobotSimulation, StallTolerantLinkedRobot, chance_of, run_live
from simbridge.robot_worlds import RobotWorlds
from simbridge.simulated_link import SimulatedLink
from simbridge.simulated_robot import MakeSensors, SimulatedRobot, infrared_sensors
from simbridge.worlds.world_loading import load_world


class PairedLink(SimulatedLink, Protocol):
    """Link of a plug-in's robot within this program, with the runtime's end and the simulated electronics."""

    @property
    def runtime_end(self) -> RobotLink:
        """End that the driver owns and closes."""
        ...

    def make_controller(self, body: Body, wheels: Wheels) -> Controller:
        """Return the electronics at the robot's end, for a robot with this body and these wheels."""
        ...


OpenLink = Callable[[RobotSettings], PairedLink]
"""Open both ends of a link. A function of a module, because a factory is sent to other processes."""


@dataclass(frozen=True, slots=True)
class LinkSimulationFactory(RobotWorlds):
    """Opener of simulations of a robot without CAN (`SimulationFactory`); can be sent to another process.

    There is no batch of such robots: a study drives them over their link.
    """

    open_link: OpenLink = field(kw_only=True)
    make_sensors: MakeSensors = field(kw_only=True, default=infrared_sensors)
    """Range sensors of the robot: a function of a module."""

    def open(self, world: str, seed: int, purpose: str) -> RobotSimulation:
        """Open the simulated robot in a world; `seed` and `purpose` make its sensors, start pose and noise.

        Raises SettingsError for an unknown world.
        """
        return self._open(world, seed, purpose, LinkedRobot)[0]

    def live(self, world: str, seed: int, tap: Tap | None = None) -> AbstractContextManager[LiveSimulation]:
        """Return a context in which a robot runs in real time.

        Raises SettingsError for an unknown world, or for a tap, which sees CAN frames.
        """
        refuse_tap(tap, self.settings.name)
        simulation, driver = self._open(world, seed, "run", StallTolerantLinkedRobot)
        return run_live(simulation, driver, simulation.simulated_robot.world.settings)

    def _open(
        self, world: str, seed: int, purpose: str, driver_class: type[LinkedRobot]
    ) -> tuple[RobotSimulation, LinkedRobot]:
        loaded = load_world(world, self.settings)
        chance = chance_of(world, seed, purpose)
        noise_seed = chance.getrandbits(32)
        link = self.open_link(self.settings)
        simulated = SimulatedRobot(
            self.settings, loaded, link.make_controller, noise_seed, robot_seed=seed, make_sensors=self.make_sensors
        )
        driver = driver_class(self.settings, link.runtime_end)
        return RobotSimulation(self.settings, simulated, driver, link, chance), driver
