"""The simulated half of the composition root: robot, world and bus, put together for experiments and for a run."""

import random
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from hal.kurt2 import Kurt2
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from kurt2rt.experiments.arena import Plan, Position, Post, Street
from kurt2rt.experiments.arena import Pose as TruePose
from kurt2rt.simulated_ground import SimulatedGround
from kurt2rt.stall_tolerant_kurt2 import StallTolerantKurt2
from simbridge.drawing import draw_robot, draw_world
from simbridge.free_poses import FreePoses
from simbridge.nearest import Clearance
from simbridge.pose import Pose
from simbridge.realtime import RealtimeSimulation
from simbridge.simulated_robot import SimulatedRobot
from simbridge.wire.line import NO_WIRE, open_line, require_wire
from simbridge.world_loading import load_world
from simbridge.world_settings import WorldSettings

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class SimulatedArena:
    """The simulated KURT2 in one world, on a CAN bus of its own (kurt2rt.experiments.arena.Arena)."""

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
        self.simulation = SimulatedRobot(settings, self._world, self._line.robot_end, noise_seed, robot_seed=seed)
        self.robot = driver(settings, self._line.notebook_end)
        self._settings = settings
        self._starts = [start.pose for start in self._world.start_poses]
        self.simulation.place(chance.choice(self._starts))

    @property
    def position(self) -> Position:
        """True position."""
        pose = self.simulation.pose
        return Position(pose.x_m, pose.y_m)

    @property
    def pose(self) -> TruePose:
        """True pose."""
        return TruePose(*self.simulation.pose)

    @property
    def plan(self) -> Plan:
        """What a course may go by, with walls where they stand now."""
        return _plan(self.simulation.world.settings)

    # Surveys of the whole world, which a run on a large map never asks for.
    @cached_property
    def _nearest(self) -> Clearance:
        return Clearance(self.simulation.world)

    @cached_property
    def _free(self) -> FreePoses:
        return FreePoses(self.simulation.world, self._settings)

    @property
    def nearest_m(self) -> float:
        """From the robot's centre to the nearest wall or obstacle."""
        pose = self.simulation.pose
        return self._nearest.distance_m((pose.x_m, pose.y_m))

    @property
    def collisions(self) -> int:
        """Contacts so far."""
        return self.simulation.collisions

    @property
    def touching(self) -> bool:
        """Whether the robot touches something now."""
        return self.simulation.touching

    @property
    def laps(self) -> float:
        """Progress along walls, in laps."""
        return self.simulation.laps

    @property
    def lap_m(self) -> float:
        """Length of a lap."""
        return self.simulation.lap_m

    def step(self) -> None:
        """One cycle of 10 ms."""
        self._line.cycle(self.simulation.step)

    def look_on(self, tap: Tap | None) -> None:
        """Somebody who sees what passes the notebook's end of the bus; None: nobody."""
        self._line.notebook_end.tap = tap

    def rescue(self) -> None:
        """Set the robot down at the nearest start pose."""
        here = self.simulation.pose

        def squared_distance(pose: Pose) -> float:
            return (pose.x_m - here.x_m) ** 2 + (pose.y_m - here.y_m) ** 2

        self.simulation.place(min(self._starts, key=squared_distance))

    def reposition(self, chance: random.Random, *, in_sight: bool, close: bool = False) -> None:
        """Set the robot down elsewhere."""
        self.simulation.place(self._free.draw(chance, close=close) if in_sight else chance.choice(self._starts))

    def put(self, pose: TruePose) -> None:
        """Set the robot down here."""
        self.simulation.place(Pose(*pose))

    @contextmanager
    def live(self) -> Iterator[RealtimeSimulation]:
        """Let the world go on by itself, in a thread and in real time, with the robot's second guard awake."""
        with (
            self._line.live(),
            RealtimeSimulation(self.simulation, self._cycle_s) as simulation,
            self.robot.watchdog,
        ):
            yield simulation

    def close(self) -> None:
        """Stop the robot and shut both ends of the bus."""
        self.robot.close()
        self._line.robot_end.shutdown()


@dataclass(frozen=True, slots=True)
class SimulatedStage:
    """Opens simulated arenas (kurt2rt.experiments.arena.Stage); can be sent to another process."""

    settings: RobotSettings
    wire: str = NO_WIRE

    def open(self, world: str, seed: int, purpose: str) -> SimulatedArena:
        """The simulated robot in a world."""
        return SimulatedArena(self.settings, world, seed, purpose, self.wire)

    def require_worlds(self, *worlds: str) -> None:
        """Look at the wire and each world, so that a long job does not fail at its last one. Raises SettingsError."""
        require_wire(self.wire)
        for world in worlds:
            load_world(world, self.settings)

    def plan_of(self, world: str) -> Plan:
        """What stands where in a world, and where its streets lead."""
        return _plan(load_world(world, self.settings))

    def draw(self, axes: "Axes", world: str) -> None:
        """Draw a world from above."""
        draw_world(axes, load_world(world, self.settings))

    def draw_robot(self, axes: "Axes", world: str) -> None:
        """Draw the robot at the first start pose of a world."""
        draw_robot(axes, load_world(world, self.settings).start_poses[0].pose, self.settings)

    def settings_of(self, world: str) -> str:
        """All that a world is made of, and the wire."""
        return f"{self.wire} {load_world(world, self.settings).model_dump_json(serialize_as_any=True)}"


def _plan(world: WorldSettings) -> Plan:
    return Plan(
        world=world.name,
        posts=tuple(Post(post.x_m, post.y_m, post.radius_m) for post in world.round_obstacles),
        streets=tuple(Street(street.from_m, street.to_m, street.width_m) for street in world.streets),
        junctions=tuple(world.junctions),
    )


@contextmanager
def simulated_robot(
    settings: RobotSettings, world: str, seed: int, wire: str = NO_WIRE, tap: Tap | None = None
) -> Iterator[tuple[SimulatedArena, SimulatedGround]]:
    """Yield the arena with the simulated robot in real time, its second guard awake, and the ground that it stands on.

    A stall of this program does not keep the robot stopped: its wheels stalled with it.

    `tap` looks on at the notebook's end of its bus. Raises SettingsError, and on leaving whatever ended the simulation.
    """
    arena = SimulatedArena(settings, world, seed, "run", wire, StallTolerantKurt2)
    arena.look_on(tap)
    try:
        with arena.live() as simulation:
            yield (
                arena,
                SimulatedGround(arena.simulation, load_world(world, settings), settings.geometry, simulation),
            )
            # While the simulation still runs, so that the last frame finds a listener.
            arena.robot.emergency_stop("the run is over")
    finally:
        arena.close()
