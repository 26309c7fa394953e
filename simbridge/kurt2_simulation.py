"""The simulated KURT2 in one world, on a CAN bus of its own."""

import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property

from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings
from hal.simulation import Pose, Position, WorldPlan
from hal.tap import Tap
from simbridge.realtime import RealtimeSimulation
from simbridge.simulated_robot import SimulatedRobot
from simbridge.simulated_world import plan_of
from simbridge.survey.clearance import Clearance
from simbridge.survey.free_poses import FreePoses
from simbridge.wire.line import NO_WIRE, open_line
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import WorldSettings


class Kurt2Simulation:
    """The simulated KURT2 in one world, on a CAN bus of its own (hal.simulation.Simulation)."""

    def __init__(
        self,
        settings: Kurt2Settings,
        world: str,
        seed: int,
        purpose: str,
        wire: str = NO_WIRE,
        driver: type[Kurt2] = Kurt2,
        loaded: WorldSettings | None = None,
        bus: str | None = None,
    ) -> None:
        """`seed` makes the robot, with the spread of its sensors; together with `purpose` it makes start and noise.

        `wire`: by name (config/wires) or path, or `none`: the bus takes no time and loses nothing.
        `driver`: drives the simulated robot over its bus. `loaded`: settings of the world; None: they are loaded.
        `bus`: that carries the frames of a robot without a wire (hal.bus.open_bus); None: one of its own.
        """
        self._world = loaded or load_world(world, settings)
        self._cycle_s = settings.cycle_s
        chance = random.Random(f"{purpose} in world {world}, seed {seed}")
        noise_seed = chance.getrandbits(32)
        self._line = open_line(wire, self._cycle_s, noise_seed, bus)
        self.simulated_robot = SimulatedRobot(settings, self._world, self._line.robot_end, noise_seed, robot_seed=seed)
        self.robot = driver(settings, self._line.notebook_end)
        self._settings = settings
        self._starts = [start.pose for start in self._world.start_poses]
        self.simulated_robot.place(chance.choice(self._starts))

    @property
    def position(self) -> Position:
        """True position of the robot, in m."""
        pose = self.simulated_robot.pose
        return Position(pose.x_m, pose.y_m)

    @property
    def pose(self) -> Pose:
        """True pose of the robot, in m and rad."""
        return self.simulated_robot.pose

    @property
    def plan(self) -> WorldPlan:
        """World from above, with walls at their present places."""
        return plan_of(self.simulated_robot.world.settings)

    # Surveys of the whole world, which a run on a large map never asks for.
    @cached_property
    def _nearest(self) -> Clearance:
        return Clearance(self.simulated_robot.world)

    @cached_property
    def _free(self) -> FreePoses:
        return FreePoses(self.simulated_robot.world, self._settings)

    @property
    def collisions(self) -> int:
        """Contacts with walls or obstacles so far."""
        return self.simulated_robot.collisions

    @property
    def touching(self) -> bool:
        """True while the robot touches something."""
        return self.simulated_robot.touching

    @property
    def laps(self) -> float:
        """Progress along walls, in laps; driving backwards counts negative."""
        return self.simulated_robot.laps

    @property
    def lap_m(self) -> float:
        """Length of a lap along the outer wall, in m."""
        return self.simulated_robot.lap_m

    def step(self) -> None:
        """Advance the world by one cycle of 10 ms. Raises hal.bus.BusError."""
        self._line.cycle(self.simulated_robot.step)

    def follow(self, poses: Sequence[Pose]) -> None:
        """Be at the last of these poses, one for each cycle that a batch simulated.

        The simulation can be stepped no more.
        """
        self.simulated_robot.follow(poses)

    def carry(self, pose: Pose) -> None:
        """Be at a pose at which a batch put the robot."""
        self.simulated_robot.carry(pose)

    def nearest_all_m(self, positions: Sequence[Position]) -> list[float]:
        """Return the distance in m from each position to the nearest wall or obstacle."""
        return self._nearest.distances_m(positions)

    def attach_tap(self, tap: Tap | None) -> None:
        """Set the tap of the notebook's bus interface; None: none."""
        self._line.notebook_end.tap = tap

    def rescue(self) -> None:
        """Put the robot, standing, at the nearest start pose."""
        self.put(self.nearest_start)

    @property
    def nearest_start(self) -> Pose:
        """Start pose that is nearest to the robot, in m and rad."""
        here = self.simulated_robot.pose

        def squared_distance(pose: Pose) -> float:
            return (pose.x_m - here.x_m) ** 2 + (pose.y_m - here.y_m) ** 2

        return min(self._starts, key=squared_distance)

    def reposition(self, chance: random.Random, *, in_sight: bool, close: bool = False) -> None:
        """Put the robot, standing, at a random start pose, or at any free pose `in_sight` of an obstacle.

        `close`: so close to it that the robot cannot turn on the spot. Raises hal.settings.SettingsError if no free
        pose is found.
        """
        self.put(self.draw_pose(chance, in_sight=in_sight, close=close))

    def draw_pose(self, chance: random.Random, *, in_sight: bool, close: bool = False) -> Pose:
        """Return a random start pose, or a free pose `in_sight` of an obstacle, in m and rad (`reposition`)."""
        return self._free.draw(chance, close=close) if in_sight else chance.choice(self._starts)

    def put(self, pose: Pose) -> None:
        """Put the robot, standing, at this pose."""
        self.simulated_robot.place(pose)

    @contextmanager
    def live(self) -> Iterator[RealtimeSimulation]:
        """Advance the world in real time in a thread, with the robot's watchdog running, until the context ends.

        Yields the thread. Leaving raises the error that ended it, if any.
        """
        with (
            self._line.live(),
            RealtimeSimulation(self.simulated_robot, self._cycle_s) as realtime,
            self.robot.watchdog,
        ):
            yield realtime

    def close(self) -> None:
        """Stop the robot and shut both ends of the bus."""
        self.robot.close()
        self._line.robot_end.shutdown()
