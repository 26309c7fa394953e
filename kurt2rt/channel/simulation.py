"""The simulation in the robot's own program, as its teacher sees it and sets it up; a real robot has none."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from kurt2rt.channel.maps import LINE, NAME, Form, MapOf
from kurt2rt.channel.schema import ManyOf, Real, Whole
from kurt2rt.timing.simulated_clock import FASTEST

_MOST_NAMES = 64


@dataclass(frozen=True, slots=True)
class TaskName:
    """A task that the robot can be taught."""

    name: str
    what: str
    """In one sentence, for the teacher."""


@dataclass(frozen=True, slots=True)
class SimulationView:
    """The simulated world and task, and those to choose from."""

    world: str
    """As it was chosen: `a`, `rooms-7`, a path."""
    task: str
    worlds: tuple[str, ...]
    """Worlds by name; `rooms-N` and `streets-N` are made for any whole number N."""
    tasks: tuple[TaskName, ...]
    speed: int = 1
    """Robot seconds in one second, as chosen."""
    reached: float = 1.0
    """The same as measured over the last second."""
    progress: float = 0.0
    """Progress of the robot with its task since the run began, in `unit`."""
    unit: str = ""
    """Unit of `progress`: laps, rounds, eights, m; empty if progress is not measured."""


SIMULATION = Form[SimulationView](
    "the simulation",
    MapOf(
        SimulationView,
        world=NAME,
        task=NAME,
        worlds=ManyOf(NAME, most=_MOST_NAMES),
        tasks=ManyOf(MapOf(TaskName, name=NAME, what=LINE), most=_MOST_NAMES),
        speed=Whole(1, FASTEST),
        reached=Real(1000.0),
        progress=Real(1e9),
        unit=NAME,
    ),
)


class TeacherNow(NamedTuple):
    """The present teacher with phase and session; the next run begins with them."""

    device: str
    phase: int
    session: str | None


class Measure(Protocol):
    """Measurement of a simulated robot's progress with its task."""

    @property
    def progress(self) -> float:
        """Since the run began, in `unit`."""
        ...

    @property
    def unit(self) -> str:
        """Unit of `progress`."""
        ...


class Simulation(Protocol):
    """The runs of a robot that is simulated in its own program. Each has one world, one task, one knowledge file."""

    async def view(self) -> SimulationView:
        """Return the simulated world and task, and those to choose from."""
        ...

    async def prepare(self, world: str | None, task: str | None, fresh: bool, teacher: TeacherNow) -> str:
        """Look whether the next run can be so, and keep it until the present one ends; return what to tell the teacher.

        `world`, `task`: None: as they are. `fresh`: with a knowledge file that holds nothing, the present one set
        aside. Raises ValueError in one line.
        """
        ...

    async def load(self, content: bytes, teacher: TeacherNow) -> str:
        """Look at knowledge that the next run is to begin with, and keep it until the present one ends.

        `content`: an export's archive, or a knowledge file. What is known now is set aside then. Returns what to tell
        the teacher. Raises ValueError in one line.
        """
        ...
