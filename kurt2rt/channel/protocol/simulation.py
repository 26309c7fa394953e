"""World, task and speed of a simulated robot, as sent to its teachers."""

from dataclasses import dataclass
from typing import Annotated

from kurt2rt.channel.protocol.limits import FASTEST
from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.core.message_fields import Finite, Int, Line, Title, UpTo


@dataclass(frozen=True, slots=True)
class TaskName:
    """A task that the robot can be taught."""

    name: Title
    what: Line
    """Sentence on the task for the teacher."""


@dataclass(frozen=True, slots=True)
class SimulationView:
    """Simulated world and task, and those to choose from."""

    world: Title
    """World as chosen: `a`, `rooms-7`, a path."""
    task: Title
    worlds: Annotated[tuple[Title, ...], UpTo(64)]
    """Worlds by name; `rooms-N`, `flats-N`, `streets-N` and `floors-N` are made for any whole number N."""
    tasks: Annotated[tuple[TaskName, ...], UpTo(64)]
    speed: Annotated[int, Int(1, FASTEST)] = 1
    """Chosen number of robot seconds in one second."""
    reached: Finite = 1.0
    """Measured number of robot seconds in the last second."""
    progress: Finite = 0.0
    """Progress of the robot with its task since the run began, in `unit`."""
    unit: Title = ""
    """Unit of `progress`: laps, rounds, eights, m; empty if progress is not measured."""


SIMULATION = Codec[SimulationView]("the simulation", SimulationView)
