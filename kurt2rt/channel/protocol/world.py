"""Simulated world for a teacher's device, seen from above."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from kurt2rt.core.teaching.message_fields import LARGEST_NUMBER, Float, Int, ListOf, Row, Text, WireError
from simbridge.contracts.simulation import SimulatedPost, Wall

_NAME = Text(64)
_METRES = Float(1000.0, "m")
_CORNERS = ListOf(Row((_METRES, _METRES)), most=1000)


@dataclass(frozen=True, slots=True)
class WorldView:
    """Walls and obstacles in metres, with the names of the wire."""

    version: int
    """Version, which grows when a wall or an obstacle is moved."""
    name: str
    size: tuple[float, float]
    outline: tuple[tuple[float, float], ...]
    walls: tuple[Wall, ...]
    round: tuple[SimulatedPost, ...]


def world_of(body: Mapping[str, Any]) -> WorldView:
    """Return the world in a decoded body. Raises WireError."""
    try:
        walls = ListOf(Row((_NAME, _CORNERS)), most=1000)("walls", body["walls"])
        posts = ListOf(Row((_NAME, _METRES, _METRES, _METRES)), most=1000)("round", body["round"])
        return WorldView(
            version=Int(0, LARGEST_NUMBER)("version", body["version"]),
            name=_NAME("name", body["name"]),
            size=Row((_METRES, _METRES))("size", body["size"]),
            outline=_CORNERS("outline", body["outline"]),
            walls=tuple(Wall(*each) for each in walls),
            round=tuple(SimulatedPost(*each) for each in posts),
        )
    except KeyError as error:
        raise WireError(f"the robot's world has no {error}") from error
