"""A simulated robot in one world, with the runtime's driver at the other end of its link; also in real time."""

import math
import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

import shapely

from config.settings_files import YAML_SUFFIXES
from hal.guard_reason import GuardReason
from hal.guarded_robot import GuardedRobot
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings
from hal.linked_robot import LinkedRobot
from hal.robot import GuardResult, WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from simbridge.contracts.simulation import LiveSimulation, Pose, Position, WallSide, WorldPlan
from simbridge.links import CanLine, SimulatedLink
from simbridge.realtime import RealtimeSimulation, RealtimeWorld, plan_of
from simbridge.robot.world import World
from simbridge.simulated_robot import SimulatedKurt2, SimulatedRobot
from simbridge.survey.drawing import draw_world
from simbridge.survey.free_poses import FreePoses
from simbridge.worlds.geometry import Point
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import WorldSettings

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class RobotWorlds:
    """Base of factories of simulations: checks, plans and draws a robot's worlds; subclasses add `open` and `live`."""

    settings: RobotSettings

    def require_worlds(self, *worlds: str) -> None:
        """Check each world, so that a long job does not fail at its last one. Raises SettingsError."""
        for world in worlds:
            load_world(world, self.settings)

    def plan_of(self, world: str) -> WorldPlan:
        """Return a world from above. Raises config.settings.SettingsError for an unknown world."""
        return plan_of(load_world(world, self.settings))

    def draw(self, axes: "Axes", world: str) -> None:
        """Draw a world from above on axes in m. Raises config.settings.SettingsError for an unknown world."""
        draw_world(axes, load_world(world, self.settings))

    def settings_of(self, world: str) -> str:
        """Return all settings of a world as a text. Raises config.settings.SettingsError for an unknown world."""
        return load_world(world, self.settings).model_dump_json(serialize_as_any=True)


class Clearance:
    """Finder of the distance in m from positions to the nearest wall or post; it follows moved walls."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._survey()

    def distances_m(self, positions: Sequence[Point]) -> list[float]:
        """Return the distance in m from each position to the nearest face; 0 inside a solid."""
        world = self._world.settings
        if world is not self._surveyed:
            self._survey()
        if not positions:
            return []  # shapely makes no points of nothing
        away_m: list[float] = shapely.distance(self._faces, shapely.points(positions)).tolist()
        if not world.round_obstacles:
            return [max(0.0, each) for each in away_m]
        posts = world.round_obstacles
        return [
            max(0.0, min([each, *(math.dist(at, (post.x_m, post.y_m)) - post.radius_m for post in posts)]))
            for each, at in zip(away_m, positions, strict=True)
        ]

    def _survey(self) -> None:
        world = self._surveyed = self._world.settings
        boxes = [shapely.Polygon(corners) for corners in world.solids]
        self._faces = shapely.GeometryCollection([shapely.LinearRing(world.outline), *boxes])
        shapely.prepare(self._faces)


class RobotSimulation:
    """A robot of any kind in one world, with its link and its driver (simbridge.contracts.simulation.Simulation)."""

    def __init__(
        self,
        settings: RobotSettings,
        simulated: SimulatedRobot,
        driver: GuardedRobot,
        link: SimulatedLink,
        chance: random.Random,
    ) -> None:
        """Place the robot at a start pose by `chance`; the simulation closes driver and link."""
        self.simulated_robot = simulated
        self.robot = driver
        self.settings = settings
        self._link = link
        self._cycle_s = settings.cycle_s
        self._starts = [start.pose for start in simulated.world.settings.start_poses]
        simulated.place(chance.choice(self._starts))

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
        return FreePoses(self.simulated_robot.world, self.settings)

    @property
    def collisions(self) -> int:
        """Contacts with walls or obstacles so far."""
        return self.simulated_robot.collisions

    @property
    def sensed_counts(self) -> tuple[int, ...]:
        """Newest readings of the simulated sensors, in counts."""
        return self.simulated_robot.infrared_counts

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

    def follow_wall(self, side: WallSide) -> None:
        """Count laps with the wall on this side of the robot, from its present place on."""
        self.simulated_robot.follow_wall(side)

    def step(self) -> None:
        """Advance the world by one cycle. Raises hal.bus.BusError."""
        self._link.cycle(self.simulated_robot.step)

    def nearest_all_m(self, positions: Sequence[Position]) -> list[float]:
        """Return the distance in m from each position to the nearest wall or obstacle."""
        return self._nearest.distances_m(positions)

    def rescue(self) -> None:
        """Put the robot, standing, at the nearest start pose."""
        self.put(self.nearest_start)

    @property
    def nearest_start(self) -> Pose:
        """Start pose that is nearest to the robot, in m and rad."""
        here = self.simulated_robot.pose

        def distance_m(pose: Pose) -> float:
            return math.dist((pose.x_m, pose.y_m), (here.x_m, here.y_m))

        return min(self._starts, key=distance_m)

    def reposition(self, chance: random.Random, *, in_sight: bool, close: bool = False) -> None:
        """Put the robot, standing, at a random start pose, or at any free pose `in_sight` of an obstacle.

        `close`: so close to it that the robot cannot turn on the spot. Raises config.settings.SettingsError if no free
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
            self._link.live(),
            RealtimeSimulation(self.simulated_robot, self._cycle_s) as realtime,
            self.robot.watchdog,
        ):
            yield realtime

    def close(self) -> None:
        """Stop the robot and close both ends of its link."""
        self.robot.close()
        self._link.close()


def chance_of(world: str, seed: int, purpose: str) -> random.Random:
    """Return the chance of a simulation: first its noise seed of 32 bits, then its start pose.

    Of a world's file only the name counts, so that a seed gives the same robot wherever the file lies.
    """
    name = Path(world).stem if world.endswith(YAML_SUFFIXES) else world
    return random.Random(f"{purpose} in world {name}, seed {seed}")


@contextmanager
def run_live(simulation: RobotSimulation, driver: GuardedRobot, world: WorldSettings) -> Iterator[LiveSimulation]:
    """Run a simulation in real time, its watchdog running, with its world for a teacher; close it at the end.

    `driver`: of the simulation, tolerant of stalls. `world`: in which it drives. Leaving raises the error that ended
    the simulation.
    """
    try:
        with simulation.live() as thread:
            ground = RealtimeWorld(simulation.simulated_robot, world, simulation.settings.geometry, thread)
            yield LiveSimulation(simulation, driver, ground)
            # While the simulation still runs, so that the last frame finds a listener.
            driver.emergency_stop(GuardReason.RUN_OVER)
    finally:
        simulation.close()


class StallTolerant(GuardedRobot):
    """Base of drivers of a robot simulated in this program: the latch of a stall ends with the next tick.

    They brake while ticks cease, as every driver does. Nothing can come to harm: wheels and walls are in the program
    that stalled. Never for a robot on a real bus, nor for a simulator in another program, which goes on while this one
    stalls.
    """

    _requested: GuardReason | None = None
    """Reason given to `emergency_stop` last; None since the last release."""

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Ask for wheel speeds in m/s; the tick that ends a stall stands, and its latch is not kept. Times in s."""
        grant = super().drive(wanted, decided_at_s, now_s)
        if not grant.latched or grant.reasons != _STALLED or self._requested is not None:
            return grant
        super().release()
        if self._requested is not None:  # by a signal's thread, just before the release
            super().emergency_stop(self._requested)
        return grant._replace(latched=self.health.latched is not None)

    def emergency_stop(self, reason: GuardReason) -> None:
        """Brake now and stay stopped until `release`, also if a stall had latched the guard before."""
        self._requested = reason
        super().emergency_stop(reason)

    def release(self) -> None:
        """End a latched stop; the robot stands until it is driven."""
        self._requested = None
        super().release()


_STALLED: Final = (GuardReason.TICKS_CEASED,)


class StallTolerantKurt2(StallTolerant, Kurt2):
    """Driver of a KURT2 that is simulated in this program, whose stalls do not keep it stopped."""


class StallTolerantLinkedRobot(StallTolerant, LinkedRobot):
    """Robot over a RobotLink whose simulation stalls with its driver."""


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
