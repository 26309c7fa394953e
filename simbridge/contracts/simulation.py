"""A simulated robot in a world: its protocols and values, for experiments, for a teacher, and for recordings.

`Simulation` drives the world in lockstep or lets it live, `SimulationFactory` opens simulations by the name of a world,
and `SimulatedWorld` is the part that a teacher may see and change. A real robot has none of them.
"""

import random
import re
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from itertools import starmap
from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol, overload

import numpy as np
from numpy.typing import NDArray

from hal.robot import Robot
from hal.robot_settings import RobotSettings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hal.guarded_robot import GuardedRobot
    from hal.tap import Tap


GENERATED_KINDS = ("rooms", "flats", "streets", "floors")
"""Kinds of generated worlds, one for each whole number of up to 9 digits, such as rooms-17."""
GENERATED_WORLD = re.compile(rf"({'|'.join(GENERATED_KINDS)})-(0|[1-9]\d{{0,8}})", re.ASCII)
"""Pattern of their names: kind and number."""


class Position(NamedTuple):
    """Centre of the robot's body in the world's frame, in metres."""

    x_m: float
    y_m: float


class Pose(NamedTuple):
    """Centre of the robot's body in the world's frame; heading counter-clockwise from the x axis, not wrapped."""

    x_m: float
    y_m: float
    heading_rad: float


class Poses(Sequence[Pose]):
    """Poses of ticks in a row over an array (n, 3), which are made when they are read, because few are."""

    def __init__(self, rows: NDArray[np.float64]) -> None:
        """Read `rows`, x, y in m and heading in rad, which must not change."""
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Pose]:
        return starmap(Pose, self._rows.tolist())

    @overload
    def __getitem__(self, place: int) -> Pose: ...

    @overload
    def __getitem__(self, place: slice) -> list[Pose]: ...

    def __getitem__(self, place: int | slice) -> Pose | list[Pose]:
        rows = self._rows[place].tolist()
        return list(starmap(Pose, rows)) if isinstance(place, slice) else Pose(*rows)


WallSide = Literal["left", "right"]
"""Side of a robot on which the wall is that it follows."""


class SimulatedPlace(NamedTuple):
    """True pose of the simulated robot in m and rad, with its laps and collisions so far."""

    x_m: float
    y_m: float
    heading_rad: float
    laps: float
    collisions: int
    world_version: int
    """Grows when a wall is moved: ask for the world again."""


class Wall(NamedTuple):
    """Wall or box of a world, seen from above."""

    name: str
    corners: tuple[tuple[float, float], ...]
    """x and y in metres."""


class SimulatedPost(NamedTuple):
    """Round obstacle of a world, seen from above."""

    name: str
    x_m: float
    y_m: float
    radius_m: float


class Street(NamedTuple):
    """Straight street of a world by its middle line, which may cross several junctions; in m."""

    from_m: tuple[float, float]
    to_m: tuple[float, float]
    width_m: float


class WorldPlan(NamedTuple):
    """World from above with walls at their present places, for metrics, drawings and the teacher's page."""

    version: int
    """Grows when a wall or an obstacle is moved."""
    name: str
    size_m: tuple[float, float]
    outline: tuple[tuple[float, float], ...]
    walls: tuple[Wall, ...]
    posts: tuple[SimulatedPost, ...]
    streets: tuple[Street, ...] = ()
    junctions: tuple[tuple[float, float], ...] = ()
    """Points where two streets meet, or one ends at another."""


class Simulation(Protocol):
    """Simulated robot in a world, in lockstep with the runtime, with the truth about both.

    Exams, metrics and pictures read pose, collisions and laps from it. The runtime and the teacher get only its
    `robot`. `SimulationFactory` opens one, by seed and world.
    """

    @property
    def robot(self) -> Robot:
        """Robot that is simulated, with its bus and its guard."""
        ...

    @property
    def position(self) -> Position:
        """True position of the robot, in m."""
        ...

    @property
    def pose(self) -> Pose:
        """True pose of the robot, in m and rad."""
        ...

    @property
    def plan(self) -> WorldPlan:
        """World seen from above, for drawings."""
        ...

    def nearest_all_m(self, positions: Sequence[Position]) -> list[float]:
        """Return the distance in m from each position to the nearest wall or obstacle."""
        ...

    @property
    def collisions(self) -> int:
        """Contacts with walls or obstacles so far."""
        ...

    @property
    def sensed_counts(self) -> tuple[int, ...]:
        """Newest readings of the simulated sensors, in counts, before they go over the link."""
        ...

    @property
    def touching(self) -> bool:
        """True while the robot touches something."""
        ...

    @property
    def laps(self) -> float:
        """Distance along walls on one side of the robot, in lengths of the outer wall; backwards counts negative.

        The side is the left until `follow_wall` names it.
        """
        ...

    @property
    def lap_m(self) -> float:
        """Length of the outer wall, in m."""
        ...

    def follow_wall(self, side: WallSide) -> None:
        """Count laps with the wall on this side of the robot, from its present place on."""
        ...

    def step(self) -> None:
        """Advance the world by one cycle of 10 ms."""
        ...

    def live(self) -> AbstractContextManager[object]:
        """Advance the world in real time in a thread, with the robot's watchdog running, until the context ends.

        Do not call `step` meanwhile. After the end, `live` may be called again. Leaving raises the error that ended the
        thread, if any.
        """
        ...

    def rescue(self) -> None:
        """Put the robot, standing, at the nearest start pose."""
        ...

    def reposition(self, chance: random.Random, *, in_sight: bool, close: bool = False) -> None:
        """Put the robot, standing, at a random start pose, or at any free pose `in_sight`.

        In sight: a sensor sees a post, or anything in a world without posts. `close`: also so close to it that the
        robot cannot turn on the spot.
        """
        ...

    def put(self, pose: Pose) -> None:
        """Put the robot, standing, at this pose."""
        ...

    def close(self) -> None:
        """Stop the robot and shut its bus down."""
        ...


class SimulationFactory(Protocol):
    """Opener of simulations of one robot in named worlds; it also checks and draws these worlds."""

    @property
    def settings(self) -> RobotSettings:
        """Settings of the robot."""
        ...

    def open(self, world: str, seed: int, purpose: str) -> Simulation:
        """Open a simulation of the robot in a world, by name.

        The seed makes the robot, with the spread of its sensors, so a robot is examined with the sensors it was taught
        with; seed and purpose ("lesson", "exam") together make the start pose and the noise. Raises
        config.settings.SettingsError for an unknown world.
        """
        ...

    def require_worlds(self, *worlds: str) -> None:
        """Check that each world can be used. Raises config.settings.SettingsError."""
        ...

    def live(self, world: str, seed: int, tap: "Tap | None" = None) -> "AbstractContextManager[LiveSimulation]":
        """Return a context in which a simulation runs in real time, with the watchdog of its driver.

        A stall of this program does not keep the robot stopped: its wheels stalled with it. Leaving stops the robot,
        and raises the error that ended the simulation. `tap` sees the CAN frames; a robot without CAN refuses one.
        Raises config.settings.SettingsError for an unknown world.
        """
        ...

    def settings_of(self, world: str) -> str:
        """Return all settings of a world as a text, which tells its versions apart.

        Raises config.settings.SettingsError for an unknown world.
        """
        ...

    def plan_of(self, world: str) -> WorldPlan:
        """Return a world from above. Raises config.settings.SettingsError for an unknown world."""
        ...

    def draw(self, axes: "Axes", world: str) -> None:
        """Draw a world from above on axes in m. Raises config.settings.SettingsError for an unknown world."""
        ...


class WorldView(Protocol):
    """View of a simulated world for recordings: the robot's true place, and the world. No call waits."""

    def place(self) -> SimulatedPlace:
        """Return the true place of the robot."""
        ...

    def world(self) -> WorldPlan:
        """Return the world from above."""
        ...


class SimulatedWorld(WorldView, Protocol):
    """World of a running simulation, as a teacher sees and changes it.

    No call waits; changes happen between two steps of the simulation.
    """

    def move_wall(self, name: str, dx_m: float, dy_m: float) -> None:
        """Shift a wall or obstacle by (dx_m, dy_m), in m.

        Raises WorldRefusedError for an unknown name, or if it would lie on the robot.
        """
        ...

    def put_robot(self, x_m: float, y_m: float, heading_rad: float) -> None:
        """Put the robot, standing, at a pose in m and rad. Raises WorldRefusedError if it does not fit there."""
        ...

    def put_robot_back(self) -> None:
        """Put the robot where the run began. Raises WorldRefusedError if it does not fit there now."""
        ...


class HeldThread(Protocol):
    """Thread that steps a simulation in real time; a clock can hold it and step by itself, to go faster."""

    def hold(self) -> None:
        """Stop the thread from stepping, until `go_on`."""
        ...

    def step(self) -> None:
        """Step one cycle while the thread is held, in the caller's thread."""
        ...

    def go_on(self) -> None:
        """Let the thread step again, after `hold`."""
        ...


class RunningWorld(SimulatedWorld, Protocol):
    """World of a simulation in real time, with the thread that steps it."""

    @property
    def held_world(self) -> HeldThread:
        """Thread that steps the simulation."""
        ...

    @property
    def lives(self) -> bool:
        """Return whether the simulation runs; False after an error has ended it."""
        ...


class LiveSimulation(NamedTuple):
    """Simulation in real time with the driver of its robot, and the world that a teacher can change."""

    simulation: Simulation
    robot: "GuardedRobot"
    """Driver of the simulated robot."""
    world: RunningWorld
