"""The simulation of a robot that is simulated in its own program."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.channel.protocol.requests.field_types import NameOrNone
from kurt2rt.channel.protocol.requests.limits import FASTEST
from kurt2rt.channel.protocol.requests.request import CommandRequest, Request
from kurt2rt.channel.protocol.schema import Flag, Int


@dataclass(frozen=True, slots=True)
class SimulationRequest(Request):
    """Query of the simulated world and task, and of those to choose from."""

    path: ClassVar[str] = "/simulation"


@dataclass(frozen=True, slots=True)
class NextRunRequest(CommandRequest):
    """End this run and begin the next one, in which the robot stands until Go."""

    path: ClassVar[str] = "/simulation/run"
    world: NameOrNone
    """None: the present one."""
    task: NameOrNone
    """None: the present one."""
    fresh: Annotated[bool, Flag()]
    """With a knowledge file that holds nothing; the present one is set aside."""


@dataclass(frozen=True, slots=True)
class SpeedRequest(CommandRequest):
    """Let robot time pass faster than real time, or as fast."""

    path: ClassVar[str] = "/simulation/speed"
    times: Annotated[int, Int(1, FASTEST)]


@dataclass(frozen=True, slots=True)
class BackToStartRequest(CommandRequest):
    """Put the simulated robot down where its run began."""

    path: ClassVar[str] = "/world/start"
