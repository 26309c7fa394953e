"""The simulated KURT2 in one world, on a CAN bus of its own."""

from collections.abc import Callable, Sequence

from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings
from hal.tap import Tap
from simbridge.contracts.simulation import Pose
from simbridge.robot_simulation import RobotSimulation, chance_of
from simbridge.simulated_kurt2 import SimulatedKurt2
from simbridge.simulated_link import CanLine
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import WorldSettings


class Kurt2Simulation(RobotSimulation):
    """The simulated KURT2 in one world, on a CAN bus of its own (simbridge.contracts.simulation.Simulation)."""

    simulated_robot: SimulatedKurt2
    robot: Kurt2

    def __init__(
        self,
        settings: Kurt2Settings,
        world: str,
        seed: int,
        purpose: str,
        driver: type[Kurt2] = Kurt2,
        loaded: WorldSettings | None = None,
        open_line: Callable[[], CanLine] = CanLine,
    ) -> None:
        """`seed` makes the robot, with the spread of its sensors; together with `purpose` it makes start and noise.

        `driver`: drives the simulated robot over its bus. `loaded`: settings of the world; None: they are loaded.
        `open_line`: opens the bus that carries the frames. Raises BusError.
        """
        loaded = loaded or load_world(world, settings)
        chance = chance_of(world, seed, purpose)
        noise_seed = chance.getrandbits(32)
        line = open_line()
        simulated = SimulatedKurt2(settings, loaded, line.robot_end, noise_seed, robot_seed=seed)
        self._notebook_end = line.notebook_end
        super().__init__(settings, simulated, driver(settings, line.notebook_end), line, chance)

    def follow(self, poses: Sequence[Pose]) -> None:
        """Be at the last of these poses, one for each cycle that a batch simulated.

        The simulation can be stepped no more.
        """
        self.simulated_robot.follow(poses)

    def carry(self, pose: Pose) -> None:
        """Set the robot to the pose at which the batch put it."""
        self.simulated_robot.carry(pose)

    def attach_tap(self, tap: Tap | None) -> None:
        """Set the tap of the notebook's bus interface; None: none."""
        self._notebook_end.tap = tap
