"""The simulation in the robot's own program, as its request handler needs it; a real robot has none."""

from typing import NamedTuple, Protocol

from kurt2rt.channel.protocol.simulation import SimulationView


class TeacherNow(NamedTuple):
    """The present teacher with phase and session; the next run begins with them."""

    device: str
    phase: int
    session: str | None


class ProgressMeter(Protocol):
    """Measurement of a simulated robot's progress with its task."""

    @property
    def progress(self) -> float:
        """Since the run began, in `unit`."""
        ...

    @property
    def unit(self) -> str:
        """Unit of `progress`."""
        ...


class RunControl(Protocol):
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
