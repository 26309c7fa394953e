"""What an experiment needs of the place where the robot drives; the composition root knows who provides it."""

import random
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

from hal.robot import Robot

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Position(NamedTuple):
    """Where the robot is, in metres."""

    x_m: float
    y_m: float


class Pose(NamedTuple):
    """Where the robot is and which way it looks: counter-clockwise from the x axis, not wrapped."""

    x_m: float
    y_m: float
    heading_rad: float


class Post(NamedTuple):
    """A round obstacle."""

    x_m: float
    y_m: float
    radius_m: float


class Street(NamedTuple):
    """A straight street by its middle line."""

    from_m: tuple[float, float]
    to_m: tuple[float, float]
    width_m: float


@dataclass(frozen=True, slots=True)
class Plan:
    """What a course may go by, from above."""

    world: str
    """Its name."""
    posts: tuple[Post, ...]
    streets: tuple[Street, ...]
    junctions: tuple[tuple[float, float], ...]
    """Where two streets meet, or one ends at another."""


class Arena(Protocol):
    """A robot in a world, watched from above. Only the experimenter sees this; neither runtime nor teacher does."""

    @property
    def robot(self) -> Robot:
        """The robot, behind its bus and its guard."""
        ...

    @property
    def position(self) -> Position:
        """True position."""
        ...

    @property
    def pose(self) -> Pose:
        """True pose."""
        ...

    @property
    def plan(self) -> Plan:
        """What stands where, and where streets lead."""
        ...

    @property
    def nearest_m(self) -> float:
        """From the robot's centre to the nearest wall or obstacle."""
        ...

    @property
    def collisions(self) -> int:
        """Contacts with walls or obstacles so far."""
        ...

    @property
    def touching(self) -> bool:
        """Whether the robot touches something now."""
        ...

    @property
    def laps(self) -> float:
        """Way made along walls with the wall on the left, in lengths of the outer wall; backwards counts against."""
        ...

    @property
    def lap_m(self) -> float:
        """Length of the way along the outer wall, in m."""
        ...

    def step(self) -> None:
        """Let the world go on by one cycle of 10 ms."""
        ...

    def rescue(self) -> None:
        """Lift the robot and set it down, standing, at the nearest start pose."""
        ...

    def reposition(self, chance: random.Random, *, in_sight: bool, close: bool = False) -> None:
        """Lift the robot and set it down, standing, elsewhere: at some start pose, or anywhere free `in_sight`.

        In sight is where a sensor sees something: a post, where the world has posts, else anything. `close`: also so
        close to it that the robot cannot turn on the spot.
        """
        ...

    def put(self, pose: Pose) -> None:
        """Lift the robot and set it down, standing, just here."""
        ...

    def close(self) -> None:
        """Stop the robot and give its bus back."""
        ...


class Stage(Protocol):
    """Opens arenas and draws their worlds."""

    def open(self, world: str, seed: int, purpose: str) -> Arena:
        """The robot in a world, by name.

        The seed makes the robot, with the spread of its sensors, so a robot is examined with the sensors it was taught
        with; seed and purpose ("lesson", "exam") together make the start pose and the noise.
        """
        ...

    def plan_of(self, world: str) -> Plan:
        """What stands where in a world, and where its streets lead. Raises hal.settings.SettingsError."""
        ...

    def draw(self, axes: "Axes", world: str) -> None:
        """Draw a world from above."""
        ...
