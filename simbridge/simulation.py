"""The simulated half of the composition root: robot, world and bus, put together for experiments and for a run."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass

from hal.kurt2_settings import Kurt2Settings
from hal.tap import Tap
from simbridge.contracts.batch import Batch, DriveSettings, FollowedSimulation, Mind, Start
from simbridge.contracts.batch_lesson import LessonDriveSettings, TaughtSimulation
from simbridge.contracts.simulation import LiveSimulation
from simbridge.kurt2_simulation import Kurt2Simulation
from simbridge.robot_simulation import StallTolerantKurt2, run_live
from simbridge.robot_worlds import RobotWorlds
from simbridge.simulated_link import CanLine
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
        from simbridge.lesson_simulation import LessonSimulation

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
