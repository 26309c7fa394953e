"""Simulated world for a teacher's device, seen from above."""

from dataclasses import dataclass
from typing import Annotated

from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.core.message_fields import Float, Number, Title, UpTo
from simbridge.contracts.simulation import SimulatedPost, Wall

Metres = Annotated[float, Float(1000.0, "m")]
Corners = Annotated[tuple[tuple[Metres, Metres], ...], UpTo(1000)]


@dataclass(frozen=True, slots=True)
class WorldView:
    """Walls and obstacles in metres, with the names of the wire."""

    version: Number
    """Version, which grows when a wall or an obstacle is moved."""
    name: Title
    size: tuple[Metres, Metres]
    outline: Corners
    walls: Annotated[tuple[Wall, ...], UpTo(1000)]
    round: Annotated[tuple[SimulatedPost, ...], UpTo(1000)]


WORLD = Codec[WorldView]("the robot's world", WorldView)
