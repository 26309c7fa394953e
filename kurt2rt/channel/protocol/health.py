"""Health report of the robot's program, made once a second."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import AfterValidator, Field, WrapSerializer

from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.channel.protocol.trouble_code import TroubleCode, numbers_of, trouble_text
from kurt2rt.core.message_fields import Int, Line, Number, Share, Text, Time, Title, Truth, UpTo, Word
from kurt2rt.core.progress import NO_PROGRESS, Progress

MOST_ROWS = 16
"""Most troubles, disks and queues in a report; further ones are left out."""


@dataclass(frozen=True, slots=True)
class Trouble:
    """Fault of the robot, its program or its machine, with its remedy: an entry of the health report.

    `HealthMonitor` finds it, `trouble_text` words it; page, `kurt2rt status` and /diagnostics show it.
    """

    code: TroubleCode
    since_s: Time
    """Duration so far in seconds."""
    urgent: Truth
    """True if the robot stands because of it, or lessons are at risk."""
    name: Title = ""
    """Sensor, folder, queue or part, as the code says."""
    numbers: Annotated[tuple[Time, ...], UpTo(4)] = ()
    line: Line = ""
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


def _complete(trouble: Trouble) -> Trouble:
    if len(trouble.numbers) < numbers_of(trouble.code):
        raise ValueError(f"trouble {trouble.code!r} has to have {numbers_of(trouble.code)} numbers")
    return trouble


def _in_words(trouble: Trouble, inner: Callable[[Trouble], dict[str, Any]]) -> dict[str, Any]:
    texts = {"about": trouble.about, "what": trouble.what, "to_do": trouble.to_do}
    return {**inner(trouble), **{key: Text(512).cut(text) for key, text in texts.items()}}


ToldTrouble = Annotated[Trouble, AfterValidator(_complete), WrapSerializer(_in_words)]
"""Trouble that tells its texts, too."""


@dataclass(frozen=True, slots=True)
class TickLateness:
    """Lateness of ticks in milliseconds, over the last minute unless stated."""

    newest_ms: Time
    """Worst lateness of the last second."""
    median_ms: Time
    p99_ms: Time
    worst_ms: Time
    took_p99_ms: Time
    """Duration of ticks, 99th percentile."""
    ticks: Number
    """Number of ticks since the program started."""
    missed: Number
    """Number of due ticks that were skipped since the program started; they are not caught up."""
    missed_lately: Number
    """Number of ticks skipped in the last minute."""


@dataclass(frozen=True, slots=True)
class SensorAges:
    """Ages of the newest frames at the tick of the report, in seconds; None before the first frame."""

    infrared_s: Time | None
    """Age of the oldest of the infra-red frames."""
    encoders_s: Time | None
    bumpers_s: Time | None


@dataclass(frozen=True, slots=True)
class BusHealth:
    """Part of the health report on the robot's bus: counters since it was opened (hal.health.Health)."""

    controller: Title
    """State of this machine's CAN controller: a value of hal.bus_state.ControllerState."""
    frames: Number
    """All frames received."""
    junk: Number
    """Frames of a known identifier with an invalid content."""
    error_frames: Number
    """Error frames of the CAN controller."""
    foreign_control: Number
    """CONTROL frames of another sender."""
    send_failures: Number
    receive_failures: Number


@dataclass(frozen=True, slots=True)
class DiskSpace:
    """Free room on the disk of one kind of file, such as recordings."""

    of: Title
    """Content of the disk: knowledge, recordings."""
    free_bytes: Number | None
    """None while the disk does not answer."""


@dataclass(frozen=True, slots=True)
class JournalHealth:
    """Part of the health report on the journal: lessons that are not durable yet, and the last write."""

    unwritten: Number
    """Number of lessons that are not durable yet."""
    last_write_ms: Time | None
    """Duration of the last durable write; None before the first."""


@dataclass(frozen=True, slots=True)
class MachineHealth:
    """Part of the health report on the machine that runs the robot program: memory, processor, battery."""

    memory_bytes: Number
    """Memory of the program; 0 if the kernel does not tell."""
    available_bytes: Number | None
    """Available memory of the machine; None if it does not tell."""
    processor_share: Time
    """Fraction of one core used in the last second."""
    threads: Number
    battery: Share | None
    """Charge of this machine's battery, 0 to 1; None without battery. No frame of KURT2 carries its own voltage."""
    discharging: Truth
    """True while that battery discharges."""


@dataclass(frozen=True, slots=True)
class Drops:
    """Number of entries that a full queue dropped since the program started."""

    of: Title
    count: Number


@dataclass(frozen=True, slots=True)
class HealthReport:
    """Report on program, bus, disks and machine once a second, for the page, `kurt2rt status` and ROS 2."""

    version: Title
    """Version of kurt2rt."""
    boot: Title
    """Random letters of this start."""
    robot: Title
    task: Title
    knowledge: Line
    """Knowledge file that keeps the lessons."""
    started_at: Title
    """Start of the program, UTC, ISO 8601."""
    uptime_s: Time
    tick: Number
    doing: Line
    """Mover of the wheels, or reason of the standstill, in a few words."""
    rlas: Number
    actions: Number
    """Number of different actions that the RLAs have."""
    lessons: Number
    """Number of lessons that stand."""
    punctuality: TickLateness
    ages: SensorAges
    bus: BusHealth | None
    """None if the robot reports no bus."""
    disks: Annotated[tuple[DiskSpace, ...], UpTo(MOST_ROWS)]
    safety: JournalHealth
    machine: MachineHealth
    drops: Annotated[tuple[Drops, ...], UpTo(MOST_ROWS)]
    troubles: Annotated[tuple[ToldTrouble, ...], UpTo(MOST_ROWS)]
    """Urgent troubles first, then by duration, longest first."""
    pages: Annotated[tuple[str, ...], Field(exclude=True), AfterValidator(lambda _: ())] = ()
    """Links to the teacher's page with their tokens, for this machine's user only, never over the channel."""
    progress: Progress = NO_PROGRESS
    """Progress of teaching in the last minute."""
    phase: Annotated[int, Int(1, 5)] = 1
    teacher: Word | None = None
    """Present teacher; None without teacher."""
    reached: Title = ""
    """Progress of a simulated robot with its task, such as `1.5 laps`; empty if it is not measured."""
    plugins: Annotated[tuple[Line, ...], UpTo(MOST_ROWS)] = ()
    """Plug-ins in use from outside of the project, each with its package and version, or file, and its hash."""

    @property
    def urgent(self) -> bool:
        """True if a trouble is urgent."""
        return any(each.urgent for each in self.troubles)


HEALTH = Codec[HealthReport]("the health report", HealthReport)
