"""World, task and speed of a simulated robot, as sent to its teachers."""

from dataclasses import dataclass

from kurt2rt.channel.protocol.cbor_schema import LINE, NAME, DataclassCodec, MapOf
from kurt2rt.channel.protocol.limits import FASTEST
from kurt2rt.core.teaching.message_fields import Float, Int, ListOf

_MOST_NAMES = 64


@dataclass(frozen=True, slots=True)
class TaskName:
    """A task that the robot can be taught."""

    name: str
    what: str
    """Sentence on the task for the teacher."""


@dataclass(frozen=True, slots=True)
class SimulationView:
    """Simulated world and task, and those to choose from."""

    world: str
    """World as chosen: `a`, `rooms-7`, a path."""
    task: str
    worlds: tuple[str, ...]
    """Worlds by name; `rooms-N`, `flats-N`, `streets-N` and `floors-N` are made for any whole number N."""
    tasks: tuple[TaskName, ...]
    speed: int = 1
    """Chosen number of robot seconds in one second."""
    reached: float = 1.0
    """Measured number of robot seconds in the last second."""
    progress: float = 0.0
    """Progress of the robot with its task since the run began, in `unit`."""
    unit: str = ""
    """Unit of `progress`: laps, rounds, eights, m; empty if progress is not measured."""


SIMULATION = DataclassCodec[SimulationView](
    "the simulation",
    MapOf(
        SimulationView,
        world=NAME,
        task=NAME,
        worlds=ListOf(NAME, most=_MOST_NAMES),
        tasks=ListOf(MapOf(TaskName, name=NAME, what=LINE), most=_MOST_NAMES),
        speed=Int(1, FASTEST),
        reached=Float(1000.0),
        progress=Float(1e9),
        unit=NAME,
    ),
)
