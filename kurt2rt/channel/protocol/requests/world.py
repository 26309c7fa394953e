"""The simulated world."""

from dataclasses import dataclass
from typing import ClassVar

from kurt2rt.channel.protocol.requests.field_types import Angle, Name, Way
from kurt2rt.channel.protocol.requests.request import CommandRequest, Request


@dataclass(frozen=True, slots=True)
class WorldRequest(Request):
    """The simulated world."""

    path: ClassVar[str] = "/world"


@dataclass(frozen=True, slots=True)
class MoveWallRequest(CommandRequest):
    """Shift a wall of the simulated world."""

    path: ClassVar[str] = "/world/move"
    name: Name
    dx_m: Way
    dy_m: Way


@dataclass(frozen=True, slots=True)
class PlaceRequest(CommandRequest):
    """Put the simulated robot down elsewhere."""

    path: ClassVar[str] = "/world/place"
    x_m: Way
    y_m: Way
    heading_rad: Angle
