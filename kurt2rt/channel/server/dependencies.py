"""Parts of the service that the channel needs, with what a robot lacks as None."""

import secrets
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.limits import BOOT_BYTES
from kurt2rt.channel.protocol.simulation import ExamStatus, SimulationView
from kurt2rt.core.outcome import Outcome
from kurt2rt.knowledge.files.atomic_write import SavedCopy
from kurt2rt.platform.file_part import FilePart
from kurt2rt.platform.simulated_clock import Speed
from simbridge.contracts.simulation import SimulatedWorld


@dataclass(frozen=True, slots=True)
class JournalStatus:
    """Queries about saving: lessons that wait, the error, and the time at which one became durable."""

    unsaved: Callable[[], int]
    """Number of lessons that are not durable yet."""
    saving_error: Callable[[], str | None]
    """Reason that lessons cannot be saved; None if they can."""
    stamp_of: Callable[[str], str]
    """Time when the lesson of a command became durable; empty before."""


class Copies(Protocol):
    """Maker of copies of the knowledge on the robot, outside the loop. Each method raises KnowledgeError."""

    def save(self, label: str) -> Awaitable[SavedCopy]:
        """Copy the knowledge file, with a label of any text in the name. Raises KnowledgeError."""
        ...

    def export(self) -> Awaitable[SavedCopy]:
        """Write the RLAs as a table (CSV). Raises KnowledgeError."""
        ...

    def package(self) -> Awaitable[SavedCopy]:
        """Write all knowledge as one file to give away. Raises KnowledgeError."""
        ...

    def examine(self) -> Awaitable[None]:
        """Begin an exam of a copy of the knowledge, without waiting for its end. Raises KnowledgeError."""
        ...

    def settle(self) -> Awaitable[None]:
        """Wait until all lessons are durable. Raises KnowledgeError."""
        ...

    def read(self, name: str, offset: int, most_bytes: int) -> Awaitable[FilePart]:
        """Return part of a copy that was made in this run, at most `most_bytes` bytes from `offset` on.

        Raises KnowledgeError if this run made no copy of that name, or it cannot be read.
        """
        ...


class TeacherNow(NamedTuple):
    """Teacher of the present run with phase and session, who teaches on in the next run."""

    device: str
    phase: int
    session: str | None


class TaskProgress(Protocol):
    """Source of a simulated robot's progress with its task, which the channel shows its teachers."""

    @property
    def progress(self) -> float:
        """Progress since the run began, in laps, rounds, eights or m as `unit` tells."""
        ...

    @property
    def unit(self) -> str:
        """Unit of `progress`, such as laps or m."""
        ...


class RunControl(Protocol):
    """Runs of a robot that is simulated in its own program; each has one world, one task, one knowledge file."""

    async def view(self) -> SimulationView:
        """Return the simulated world and task, and those to choose from."""
        ...

    async def prepare(self, world: str | None, task: str | None, fresh: bool, teacher: TeacherNow) -> Outcome:
        """Check the next run and keep it until the present one ends; return the outcome for the teacher.

        Args:
            world: World by name. None: the present one.
            task: Task by name. None: the present one.
            fresh: Begin with an empty knowledge file and archive the present one.
            teacher: Teacher of the next run.

        Raises:
            CommandRefusedError: the run is refused, with the reason for the teacher.
            UserError: settings or knowledge cannot be loaded.
        """
        ...

    async def load(self, content: bytes, teacher: TeacherNow) -> Outcome:
        """Check knowledge for the next run and keep it until the present one ends; return the outcome for the teacher.

        Args:
            content: Archive of an export, or a knowledge file; the present knowledge is archived then.
            teacher: Teacher of the next run.

        Raises:
            CommandRefusedError: the run is refused, with the reason for the teacher.
            UserError: the knowledge is damaged, or does not fit robot or task.
        """
        ...


@dataclass(frozen=True, slots=True)
class ChannelDependencies:
    """Parts of the service that the channel reads and calls; None for what a robot lacks."""

    journal: JournalStatus
    copies: Copies
    bus_trouble: Callable[[], str]
    world: SimulatedWorld | None
    """None for a real robot."""
    boot: bytes = field(default_factory=lambda: secrets.token_bytes(BOOT_BYTES))
    """Random bytes of this start."""
    health: Callable[[], HealthReport | None] = lambda: None
    """Newest report; None before the first."""
    exam: Callable[[], ExamStatus] | None = None
    """Status of the exam; None if the robot is not examined."""
    run_control: RunControl | None = None
    """None if the simulator is not in this program."""
    speed: Speed | None = None
    """None if robot time is real time."""
    progress: TaskProgress | None = None
    """None if progress is not measured."""
