"""The health report: how the robot's program is, once a second."""

from dataclasses import dataclass

from kurt2rt.channel.protocol.trouble_code import TroubleCode
from kurt2rt.channel.protocol.trouble_text import trouble_text
from kurt2rt.core.teaching.progress import NO_PROGRESS, Progress


@dataclass(frozen=True, slots=True)
class Trouble:
    """A fault of the robot, its program or its machine."""

    code: TroubleCode
    since_s: float
    """Duration so far."""
    urgent: bool
    """The robot stands because of it, or lessons are at risk."""
    name: str = ""
    """Sensor, folder, queue or part, as the code says."""
    numbers: tuple[float, ...] = ()
    line: str = ""
    """`what is wrong; what to do`, of codes without a text of their own."""

    @property
    def about(self) -> str:
        """Subject: lateness, ticks, sensors, bus, lessons, disk, queues, machine, or program for the rest."""
        return self.code.about or self.name

    @property
    def what(self) -> str:
        """Text of the fault."""
        return trouble_text(self.code, self.name, self.numbers, self.line)[0]

    @property
    def to_do(self) -> str:
        """Text of the remedy; empty if only waiting helps."""
        return trouble_text(self.code, self.name, self.numbers, self.line)[1]


@dataclass(frozen=True, slots=True)
class TickLateness:
    """How late ticks begin, of the last minute unless said otherwise, in milliseconds."""

    newest_ms: float
    """The worst of the last second."""
    median_ms: float
    p99_ms: float
    worst_ms: float
    took_p99_ms: float
    """How long ticks take, 99th percentile."""
    ticks: int
    """Since the program was started."""
    missed: int
    """Of those that were due since the program was started; skipped whole, never caught up."""
    missed_lately: int
    """In the last minute."""


@dataclass(frozen=True, slots=True)
class SensorAges:
    """How old the newest frame of each kind was in the tick of the report, in seconds; None: none has come."""

    infrared_s: float | None
    """Of the oldest of the infra-red frames."""
    encoders_s: float | None
    bumpers_s: float | None


@dataclass(frozen=True, slots=True)
class BusHealth:
    """The robot's bus, by counters since it was opened."""

    controller: str
    """State of this machine's CAN controller: a value of hal.bus_state.ControllerState."""
    frames: int
    junk: int
    error_frames: int
    foreign_control: int
    """CONTROL frames of somebody else."""
    send_failures: int
    receive_failures: int


@dataclass(frozen=True, slots=True)
class DiskSpace:
    """Room for one kind of file."""

    of: str
    """What is kept there: knowledge, recordings."""
    free_bytes: int | None
    """None while the disk does not answer."""


@dataclass(frozen=True, slots=True)
class JournalHealth:
    """How lessons fare on their way to the disk."""

    unwritten: int
    """Lessons that are not durable yet."""
    last_write_ms: float | None
    """How long the disk took to keep the last ones; None before the first."""


@dataclass(frozen=True, slots=True)
class MachineHealth:
    """The program and the machine that it runs on."""

    memory_bytes: int
    """That the program holds; 0 where the kernel does not tell."""
    available_bytes: int | None
    """That the machine could still give; None where it does not tell."""
    processor_share: float
    """Of one core, in the last second."""
    threads: int
    battery: float | None
    """Charge of the machine that the program runs on, 0 to 1; None where it has no battery. The robot tells none of
    its own: no frame of KURT2 carries a voltage.
    """
    discharging: bool
    """Whether that battery is being used up."""


@dataclass(frozen=True, slots=True)
class Drops:
    """What one queue threw away since the program was started, because whoever empties it did not keep up."""

    of: str
    count: int


@dataclass(frozen=True, slots=True)
class HealthReport:
    """All of it, as of one tick."""

    version: str
    """Of kurt2rt."""
    boot: str
    """Random letters of this start."""
    robot: str
    task: str
    knowledge: str
    """File that lessons are kept in."""
    started_at: str
    """UTC, ISO 8601."""
    uptime_s: float
    tick: int
    doing: str
    """Who moves the wheels, or why they stand, in a few words."""
    rlas: int
    lessons: int
    """That stand."""
    punctuality: TickLateness
    ages: SensorAges
    bus: BusHealth | None
    """None where the robot does not tell of one."""
    disks: tuple[DiskSpace, ...]
    safety: JournalHealth
    machine: MachineHealth
    drops: tuple[Drops, ...]
    troubles: tuple[Trouble, ...]
    """The urgent ones first, then those that have lasted longest."""
    pages: tuple[str, ...] = ()
    """Links to the teacher's page, with their tokens: told to this machine's own user alone, never over the channel."""
    progress: Progress = NO_PROGRESS
    """Of teaching, in the last minute."""

    @property
    def urgent(self) -> bool:
        """Whether one of the troubles is."""
        return any(each.urgent for each in self.troubles)
