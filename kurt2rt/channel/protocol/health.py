"""Health report of the robot's program, made once a second."""

from dataclasses import dataclass

from kurt2rt.channel.protocol.trouble_code import TroubleCode, trouble_text
from kurt2rt.core.teaching.progress import NO_PROGRESS, Progress


@dataclass(frozen=True, slots=True)
class Trouble:
    """Fault of the robot, its program or its machine, with its remedy: an entry of the health report.

    `HealthMonitor` finds it, `trouble_text` words it; page, `kurt2rt status` and /diagnostics show it.
    """

    code: TroubleCode
    since_s: float
    """Duration so far in seconds."""
    urgent: bool
    """True if the robot stands because of it, or lessons are at risk."""
    name: str = ""
    """Sensor, folder, queue or part, as the code says."""
    numbers: tuple[float, ...] = ()
    line: str = ""
    """`what is wrong; what to do`, of codes without a text of their own."""

    @property
    def about(self) -> str:
        """Subject: lateness, ticks, sensors, bus, lessons, disk, queues, machine, or program for the rest."""
        return self.code.about

    @property
    def what(self) -> str:
        """Sentence on the fault, from its code and numbers."""
        return trouble_text(self.code, self.name, self.numbers, self.line)[0]

    @property
    def to_do(self) -> str:
        """Text of the remedy; empty if only waiting helps."""
        return trouble_text(self.code, self.name, self.numbers, self.line)[1]


@dataclass(frozen=True, slots=True)
class TickLateness:
    """Lateness of ticks in milliseconds, over the last minute unless stated."""

    newest_ms: float
    """Worst lateness of the last second."""
    median_ms: float
    p99_ms: float
    worst_ms: float
    took_p99_ms: float
    """Duration of ticks, 99th percentile."""
    ticks: int
    """Number of ticks since the program started."""
    missed: int
    """Number of due ticks that were skipped since the program started; they are not caught up."""
    missed_lately: int
    """Number of ticks skipped in the last minute."""


@dataclass(frozen=True, slots=True)
class SensorAges:
    """Ages of the newest frames at the tick of the report, in seconds; None before the first frame."""

    infrared_s: float | None
    """Age of the oldest of the infra-red frames."""
    encoders_s: float | None
    bumpers_s: float | None


@dataclass(frozen=True, slots=True)
class BusHealth:
    """Counters of the robot's bus since it was opened."""

    controller: str
    """State of this machine's CAN controller: a value of hal.bus_state.ControllerState."""
    frames: int
    """All frames received."""
    junk: int
    """Frames of a known identifier with an invalid content."""
    error_frames: int
    """Error frames of the CAN controller."""
    foreign_control: int
    """CONTROL frames of another sender."""
    send_failures: int
    receive_failures: int


@dataclass(frozen=True, slots=True)
class DiskSpace:
    """Free room on the disk of one kind of file, such as recordings."""

    of: str
    """Content of the disk: knowledge, recordings."""
    free_bytes: int | None
    """None while the disk does not answer."""


@dataclass(frozen=True, slots=True)
class JournalHealth:
    """State of the lessons on their way to the disk."""

    unwritten: int
    """Number of lessons that are not durable yet."""
    last_write_ms: float | None
    """Duration of the last durable write; None before the first."""


@dataclass(frozen=True, slots=True)
class MachineHealth:
    """Program and the machine that it runs on."""

    memory_bytes: int
    """Memory of the program; 0 if the kernel does not tell."""
    available_bytes: int | None
    """Available memory of the machine; None if it does not tell."""
    processor_share: float
    """Fraction of one core used in the last second."""
    threads: int
    battery: float | None
    """Charge of this machine's battery, 0 to 1; None without battery. No frame of KURT2 carries its own voltage."""
    discharging: bool
    """True while that battery discharges."""


@dataclass(frozen=True, slots=True)
class Drops:
    """Number of entries that a full queue dropped since the program started."""

    of: str
    count: int


@dataclass(frozen=True, slots=True)
class HealthReport:
    """Health of program, bus, disks and machine at one tick."""

    version: str
    """Version of kurt2rt."""
    boot: str
    """Random letters of this start."""
    robot: str
    task: str
    knowledge: str
    """Knowledge file that keeps the lessons."""
    started_at: str
    """Start of the program, UTC, ISO 8601."""
    uptime_s: float
    tick: int
    doing: str
    """Mover of the wheels, or reason of the standstill, in a few words."""
    rlas: int
    lessons: int
    """Number of lessons that stand."""
    punctuality: TickLateness
    ages: SensorAges
    bus: BusHealth | None
    """None if the robot reports no bus."""
    disks: tuple[DiskSpace, ...]
    safety: JournalHealth
    machine: MachineHealth
    drops: tuple[Drops, ...]
    troubles: tuple[Trouble, ...]
    """Urgent troubles first, then by duration, longest first."""
    pages: tuple[str, ...] = ()
    """Links to the teacher's page with their tokens, for this machine's user only, never over the channel."""
    progress: Progress = NO_PROGRESS
    """Progress of teaching in the last minute."""
    plugins: tuple[str, ...] = ()
    """Plug-ins in use from outside of the project, each with its package and version, or file, and its hash."""

    @property
    def urgent(self) -> bool:
        """True if a trouble is urgent."""
        return any(each.urgent for each in self.troubles)
