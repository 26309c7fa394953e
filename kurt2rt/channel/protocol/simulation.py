"""World, task and speed of a simulated robot, as sent to its teachers."""

from dataclasses import dataclass
from typing import Annotated

from kurt2rt.channel.protocol.limits import FASTEST
from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.core.message_fields import Finite, Float, Int, Line, Number, Share, Title, Truth, UpTo
from simbridge.contracts.simulation import SimulatedPost, Wall


@dataclass(frozen=True, slots=True)
class WorldVerdict:
    """Result of an exam in one world, compared with the drive of the teacher's own policy there."""

    world: Title
    passed: Truth
    text: Line
    """Progress compared with the teacher's own policy, collisions, early end."""
    judged: Truth = True
    """False if the teacher's own policy makes no progress in this world; `passed` means nothing then."""


@dataclass(frozen=True, slots=True)
class ExamStatus:
    """Progress of the exam under way, or verdicts of the newest one, as the page and the terminal show it."""

    running: Truth
    share: Share
    """Fraction of the robot time that is over, 0 to 1."""
    text: Line
    """Present drive, or the verdict in a sentence; empty before the first exam."""
    verdicts: Annotated[tuple[WorldVerdict, ...], UpTo(32)] = ()
    """One verdict per world; empty until the exam is over."""
    picture: Title = ""
    """Name of the PNG file, to be fetched as `/file`; empty until it is drawn."""
    trouble: Line = ""
    """Reason of a missing verdict in a line; empty without error."""


NO_EXAM = ExamStatus(False, 0.0, "")

EXAM = Codec[ExamStatus]("the exam", ExamStatus)


Metres = Annotated[float, Float(1000.0, "m")]
Corners = Annotated[tuple[tuple[Metres, Metres], ...], UpTo(1000)]


@dataclass(frozen=True, slots=True)
class WorldView:
    """Simulated world from above, as a device receives it: outline, walls and posts in m."""

    version: Number
    """Version, which grows when a wall or an obstacle is moved."""
    name: Title
    size: tuple[Metres, Metres]
    outline: Corners
    walls: Annotated[tuple[Wall, ...], UpTo(1000)]
    round: Annotated[tuple[SimulatedPost, ...], UpTo(1000)]


WORLD = Codec[WorldView]("the robot's world", WorldView)


@dataclass(frozen=True, slots=True)
class TaskName:
    """Task to choose for the next run of a simulated robot, with a sentence on it for the teacher."""

    name: Title
    what: Line
    """Sentence on the task for the teacher."""


@dataclass(frozen=True, slots=True)
class SimulationView:
    """World, task and speed of a simulated robot, and the choices that its teacher has for the next run."""

    world: Title
    """World as chosen: `a`, `rooms-7`, a path."""
    task: Title
    worlds: Annotated[tuple[Title, ...], UpTo(64)]
    """Worlds by name; those that end in `-N`, such as `rooms-N`, are made for any whole number N of up to 9 digits."""
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
