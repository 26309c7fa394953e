"""The simulated half of the composition root: openers of simulations of KURT2, and of robots that are plug-ins."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Protocol

from hal.kurt2_settings import Kurt2Settings
from hal.linked_robot import LinkedRobot
from hal.robot_link import RobotLink
from hal.robot_settings import RobotSettings
from hal.tap import Tap, refuse_tap
from simbridge.contracts.batch import Batch, DriveSettings, FollowedSimulation, Mind, Start
from simbridge.contracts.batch_lesson import LessonDriveSettings, TaughtSimulation
from simbridge.contracts.simulation import LiveSimulation
from simbridge.controller.controller import Controller
from simbridge.links import CanLine, SimulatedLink
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels
from simbridge.robot_simulation import (
    Kurt2Simulation,
    RobotSimulation,
    RobotWorlds,
    StallTolerantKurt2,
    StallTolerantLinkedRobot,
    chance_of,
    run_live,
)
from simbridge.simulated_robot import MakeSensors, SimulatedRobot, infrared_sensors
from simbridge.worlds.world_loading import load_world


@dataclass(frozen=True, slots=True)
class Kurt2SimulationFactory(RobotWorlds):
    """Opener of simulations and batches of KURT2; can be sent to another process.

    It is a simbridge.contracts.simulation.SimulationFactory.
    """

    settings: Kurt2Settings
    bus: str | None = None
    """Bus that carries the frames, for one simulation at a time; None: one of its own."""

    def open(self, world: str, seed: int, purpose: str) -> Kurt2Simulation:
        """Open the simulated robot in a world; `seed` and `purpose` make its sensors, start pose and noise.

        Raises BusError for a bus that cannot be opened, SettingsError for an unknown world.
        """
        return Kurt2Simulation(self.settings, world, seed, purpose, open_line=self._open_line)

    def open_all(self, starts: Sequence[Start], purpose: str) -> list[FollowedSimulation]:
        """Open a simulation for each start; a world that several share is loaded once (contracts.batch.BatchFactory).

        Raises SettingsError for an unknown world.
        """
        worlds = {world: load_world(world, self.settings) for world in dict.fromkeys(start.world for start in starts)}
        opened: list[FollowedSimulation] = []
        try:
            for world, seed in starts:
                opened.append(Kurt2Simulation(self.settings, world, seed, purpose, loaded=worlds[world]))
        except BaseException:
            for each in opened:
                each.close()
            raise
        return opened

    def open_batch(
        self, simulations: Sequence[FollowedSimulation], minds: Sequence[Mind], settings: DriveSettings
    ) -> Batch:
        """Return a batch of the robots of fresh simulations (simbridge.contracts.batch.BatchFactory).

        Raises BatchRefusedError for what the batch does not know.
        """
        # Late import: the compiler takes a third of a second.
        from simbridge.batch.batch import RobotBatch

        robots = [each.simulated_robot for each in simulations if isinstance(each, Kurt2Simulation)]
        return RobotBatch(self.settings, robots, minds, settings)

    def open_lesson(self, world: str, seed: int, purpose: str, settings: LessonDriveSettings) -> TaughtSimulation:
        """Open a simulation whose robot is taught in a batch (simbridge.contracts.batch_lesson.LessonFactory).

        Raises BatchRefusedError for what the batch does not know, SettingsError for an unknown world.
        """
        from simbridge.batch.lesson import LessonSimulation

        return LessonSimulation(self.settings, world, seed, purpose, settings)

    def live(self, world: str, seed: int, tap: Tap | None = None) -> AbstractContextManager[LiveSimulation]:
        """Return a context in which a robot runs in real time (simbridge.contracts.simulation.SimulationFactory).

        `tap`: sees the frames at the notebook's end of its bus. Raises SettingsError for an unknown world.
        """
        loaded = load_world(world, self.settings)
        simulation = Kurt2Simulation(
            self.settings, world, seed, "run", StallTolerantKurt2, loaded=loaded, open_line=self._open_line
        )
        simulation.attach_tap(tap)
        return run_live(simulation, simulation.robot, loaded)

    def _open_line(self) -> CanLine:
        return CanLine(self.bus)


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
