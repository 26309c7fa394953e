"""What an experiment needs of the place where the robot drives; the composition root knows who provides it."""

from typing import TYPE_CHECKING, NamedTuple, Protocol

from hal.robot import Robot

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Position(NamedTuple):
    """Where the robot is, in metres."""

    x_m: float
    y_m: float


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
    def collisions(self) -> int:
        """Contacts with walls or obstacles so far."""
        ...

    @property
    def touching(self) -> bool:
        """Whether the robot touches something now."""
        ...

    @property
    def laps(self) -> float:
        """Way made along the world's outline with the wall on the left, in whole rounds; backwards counts against."""
        ...

    def step(self) -> None:
        """Let the world go on by one cycle of 10 ms."""
        ...

    def rescue(self) -> None:
        """Lift the robot and set it down, standing, at the nearest start pose."""
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

    def draw(self, axes: "Axes", world: str) -> None:
        """Draw a world from above."""
        ...
