"""The simulated world, as a teacher may see and change it; a real robot has none to tell of."""

from typing import NamedTuple, Protocol

from kurt2rt.channel.state import SimulatedPlace


class Wall(NamedTuple):
    """A wall or a box from above."""

    name: str
    corners: tuple[tuple[float, float], ...]
    """x and y in metres."""


class Post(NamedTuple):
    """A round obstacle from above."""

    name: str
    x_m: float
    y_m: float
    radius_m: float


class WorldView(NamedTuple):
    """The world from above, as it is now."""

    version: int
    name: str
    size_m: tuple[float, float]
    outline: tuple[tuple[float, float], ...]
    walls: tuple[Wall, ...]
    posts: tuple[Post, ...]


class Ground(Protocol):
    """Where a simulated robot stands. Nothing here waits; changes happen between two steps of the simulation."""

    def place(self) -> SimulatedPlace:
        """Where the robot is."""
        ...

    def world(self) -> WorldView:
        """The world."""
        ...

    def move_wall(self, name: str, dx_m: float, dy_m: float) -> None:
        """Shift a wall or obstacle. Raises ValueError in a sentence for the teacher."""
        ...

    def put_robot(self, x_m: float, y_m: float, heading_rad: float) -> None:
        """Put the robot down elsewhere. Raises ValueError in a sentence for the teacher."""
        ...

    def put_robot_back(self) -> None:
        """Put the robot down where the run began. Raises ValueError in a sentence for the teacher."""
        ...
