"""The simulated half of the composition root: robot, world and bus, put together for experiments and for a run."""

import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from hal.batch import Batch, DriveSettings, FollowedSimulation, Mind
from hal.batch_lesson import LessonDriveSettings, LessonRobot
from hal.batch_refusal import BatchRefusedError
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.robot_settings import RobotSettings
from hal.simulation import Pose, Position, WorldPlan
from hal.tap import Tap
from simbridge.realtime import RealtimeSimulation
from simbridge.simulated_robot import SimulatedRobot
from simbridge.simulated_world import Kurt2World, plan_of
from simbridge.stall_tolerant_kurt2 import StallTolerantKurt2
from simbridge.survey.clearance import Clearance
from simbridge.survey.drawing import draw_robot, draw_world
from simbridge.survey.free_poses import FreePoses
from simbridge.wire.line import NO_WIRE, open_line, require_wire
from simbridge.worlds.world_loading import load_world

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Kurt2Simulation:
    """The simulated KURT2 in one world, on a CAN bus of its own (hal.simulation.Simulation)."""

    def __init__(
        self,
        settings: RobotSettings,
        world: str,
        seed: int,
        purpose: str,
        wire: str = NO_WIRE,
        driver: type[Kurt2] = Kurt2,
    ) -> None:
        """`seed` makes the robot, with the spread of its sensors; together with `purpose` it makes start and noise.

        `wire`: by name (config/wires) or path, or `none`: the bus takes no time and loses nothing.
        `driver`: drives the simulated robot over its bus.
        """
        self._world = load_world(world, settings)
        self._cycle_s = settings.can.cycle_s
        chance = random.Random(f"{purpose} in world {world}, seed {seed}")
        noise_seed = chance.getrandbits(32)
        self._line = open_line(wire, self._cycle_s, noise_seed)
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
    def nearest_m(self) -> float:
        """Distance in m from the robot's centre to the nearest wall or obstacle."""
        pose = self.simulated_robot.pose
        return self._nearest.distance_m((pose.x_m, pose.y_m))

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


@dataclass(frozen=True, slots=True)
class Kurt2SimulationFactory:
    """Opens simulated simulations (hal.simulation.SimulationFactory); can be sent to another process."""

    settings: RobotSettings
    wire: str = NO_WIRE

    def open(self, world: str, seed: int, purpose: str) -> Kurt2Simulation:
        """Open the simulated robot in a world; `seed` and `purpose` make its sensors, start pose and noise.

        Raises SettingsError for an unknown world or wire.
        """
        return Kurt2Simulation(self.settings, world, seed, purpose, self.wire)

    def open_batch(
        self, simulations: Sequence[FollowedSimulation], minds: Sequence[Mind], settings: DriveSettings
    ) -> Batch:
        """Return a batch of the robots of fresh simulations (hal.batch.BatchFactory).

        Raises BatchRefusedError for what the batch does not know.
        """
        # Late import: the compiler takes a third of a second.
        from simbridge.batch.batch import RobotBatch

        if self.wire != NO_WIRE:
            raise BatchRefusedError(f"wire {self.wire}: a batch has no wire", do="leave --wire out")
        robots = [each.simulated_robot for each in simulations if isinstance(each, Kurt2Simulation)]
        return RobotBatch(self.settings, robots, minds, settings)

    def open_lesson(self, world: str, seed: int, purpose: str, settings: LessonDriveSettings) -> LessonRobot:
        """Open a simulation whose robot is taught in a batch (hal.batch_lesson.LessonFactory).

        Raises BatchRefusedError for what the batch does not know, SettingsError for an unknown world.
        """
        from simbridge.batch.lesson_simulation import LessonSimulation

        if self.wire != NO_WIRE:
            raise BatchRefusedError(f"wire {self.wire}: a batch has no wire", do="leave --wire out")
        return LessonSimulation(self.settings, world, seed, purpose, settings)

    def require_worlds(self, *worlds: str) -> None:
        """Check the wire and each world, so that a long job does not fail at its last one. Raises SettingsError."""
        require_wire(self.wire)
        for world in worlds:
            load_world(world, self.settings)

    def plan_of(self, world: str) -> WorldPlan:
        """Return a world from above. Raises hal.settings.SettingsError for an unknown world."""
        return plan_of(load_world(world, self.settings))

    def draw(self, axes: "Axes", world: str) -> None:
        """Draw a world from above on axes in m. Raises hal.settings.SettingsError for an unknown world."""
        draw_world(axes, load_world(world, self.settings))

    def draw_robot(self, axes: "Axes", world: str) -> None:
        """Draw the robot at the first start pose of a world, on axes in m.

        Raises hal.settings.SettingsError for an unknown world.
        """
        draw_robot(axes, load_world(world, self.settings).start_poses[0].pose, self.settings)

    def settings_of(self, world: str) -> str:
        """Return all settings of a world, and the wire, as a text.

        Raises hal.settings.SettingsError for an unknown world.
        """
        return f"{self.wire} {load_world(world, self.settings).model_dump_json(serialize_as_any=True)}"


@contextmanager
def simulated_robot(
    settings: RobotSettings, world: str, seed: int, wire: str = NO_WIRE, tap: Tap | None = None
) -> Iterator[tuple[Kurt2Simulation, Kurt2World]]:
    """Yield a simulation that runs in real time, its watchdog running, and its world for a teacher.

    A stall of this program does not keep the robot stopped: its wheels stalled with it. `tap` sees the frames at the
    notebook's end of its bus. Raises SettingsError for an unknown world or wire, and on leaving the error that ended
    the simulation.
    """
    simulation = Kurt2Simulation(settings, world, seed, "run", wire, StallTolerantKurt2)
    simulation.attach_tap(tap)
    try:
        with simulation.live() as realtime:
            yield (
                simulation,
                Kurt2World(simulation.simulated_robot, load_world(world, settings), settings.geometry, realtime),
            )
            # While the simulation still runs, so that the last frame finds a listener.
            simulation.robot.emergency_stop(GuardReason.RUN_OVER)
    finally:
        simulation.close()
