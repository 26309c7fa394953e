"""The simulated world as a teacher's device sees it from above."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hal.simulation import Post, Wall
from kurt2rt.channel.protocol.requests import LARGEST_NUMBER
from kurt2rt.channel.protocol.schema import ManyOf, Real, Row, Text, Whole, WireError

_NAME = Text(64)
_METRES = Real(1000.0, "m")
_CORNERS = ManyOf(Row((_METRES, _METRES)), most=1000)


@dataclass(frozen=True, slots=True)
class World:
    """Walls and obstacles; all in metres, with the names of the wire."""

    version: int
    """Grows when something is moved."""
    name: str
    size: tuple[float, float]
    outline: tuple[tuple[float, float], ...]
    walls: tuple[Wall, ...]
    round: tuple[Post, ...]


def world_of(body: Mapping[str, Any]) -> World:
    """The world in a decoded body. Raises WireError."""
    try:
        walls = ManyOf(Row((_NAME, _CORNERS)), most=1000)("walls", body["walls"])
        posts = ManyOf(Row((_NAME, _METRES, _METRES, _METRES)), most=1000)("round", body["round"])
        return World(
            version=Whole(0, LARGEST_NUMBER)("version", body["version"]),
            name=_NAME("name", body["name"]),
            size=Row((_METRES, _METRES))("size", body["size"]),
            outline=_CORNERS("outline", body["outline"]),
            walls=tuple(Wall(*each) for each in walls),
            round=tuple(Post(*each) for each in posts),
        )
    except KeyError as error:
        raise WireError(f"the robot's world has no {error}") from error
