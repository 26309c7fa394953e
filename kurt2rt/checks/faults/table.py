"""Schema of `config/faults/*.yaml`: what fails, in which way, and what the robot must do then."""

from collections.abc import Iterator
from typing import Annotated, Literal, NamedTuple, Self, get_args

from pydantic import Field, model_validator

from hal.settings import Settings, find_config, load_settings

Target = Literal[
    "sensor_board_1",
    "sensor_board_2",
    "encoders",
    "left_motor",
    "right_motor",
    "bus_in",
    "bus_out",
    "teacher_link",
    "disk",
    "clock",
    "tick",
    "recorder",
]
"""What can fail. bus_in is the way from robot to notebook, bus_out the one back."""

Kind = Literal["off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent"]
"""The ways in which it fails: gives nothing, repeats itself, gives nonsense, gives what is plausible and false, comes
less often, comes late, comes and goes."""

LeadsTo = Literal["stands", "asks", "stutters", "drives_on"]
"""stands: until the fault is over at least. asks: stands because it does not know the situation. stutters: stands for
moments. drives_on: never stands."""

EndsBy = Literal["itself", "resume", "press", "restart"]
"""What makes it drive again when the fault is over: nothing else, a teacher's resume, a new press of the hand, a new
start of the program and a resume."""

TARGETS: tuple[Target, ...] = get_args(Target)
KINDS: tuple[Kind, ...] = get_args(Kind)

Seconds = Annotated[float, Field(gt=0, le=10)]


class EnvelopeSettings(Settings):
    """The limits of every frame that moves the robot, written down a second time, apart from the guard's own."""

    speed_m_s: Annotated[float, Field(gt=0, le=3)]
    acceleration_m_s2: Annotated[float, Field(gt=0, le=20)]
    braking_m_s2: Annotated[float, Field(gt=0, le=20)]
    resolution_m_s: Annotated[float, Field(gt=0, le=0.1)]
    longest_step_s: Seconds
    """From one frame to the next no more speed is gained or lost than in so long, however late the tick was; and so
    much at once after a brake, for the guard counts from its last set point."""
    command_age_s: Seconds
    controller_watchdog_s: Seconds


class CaseSettings(Settings):
    """One case: how it fails, and what must come of it."""

    period_s: Seconds = 1.0
    """slow: between two that come, or time constant. intermittent: each span of failing, and each of working."""
    delay_s: Seconds = 1.0
    """How late, or how long something hangs each time."""
    lasts_s: Seconds | None = None
    """Where it is not the schedule's time."""
    stop_said_after_s: Seconds | None = None
    """A teacher says stop so long after the fault began, to see whether the robot still obeys."""
    leads_to: LeadsTo
    because: str | tuple[str, ...] = ()
    """Word of the guard, or cause of the decision, for the standstill; one of several where chance has a say."""
    within_s: Seconds | None = None
    """From the fault's beginning to the standstill at the robot's end of the bus, the first one of a robot that
    stutters."""
    latches: str | None = None
    """Word of the guard for which it stays stopped in the end."""
    latches_within_s: Seconds | None = None
    ends_by: EndsBy
    counts: str | None = None
    """What is lost or refused, and must be counted."""
    old_frames: Annotated[int, Field(ge=0, le=10)] = 0
    """Set points older than the command's age may arrive at the robot, where frames are held up behind the guard."""
    slew_share: Annotated[float, Field(ge=1, le=3)] = 1.0
    """So many times the slew limit, where the clock itself is wrong by which slew is measured."""
    known_gap: str | None = None
    """What the program does worse than this row says, and why; the row fails when that is mended."""
    why: str

    @property
    def words(self) -> tuple[str, ...]:
        """Those of `because`."""
        return (self.because,) if isinstance(self.because, str) else self.because

    @model_validator(mode="after")
    def _says_when_it_stands(self) -> Self:
        stands = self.leads_to != "drives_on"
        if stands is not bool(self.because) or stands is (self.within_s is None):
            raise ValueError("because and within_s belong to a robot that stands, and to no other")
        if (self.latches is None) is not (self.latches_within_s is None):
            raise ValueError("latches and latches_within_s belong together")
        if self.leads_to in ("drives_on", "stutters") and (self.ends_by != "itself" or self.latches):
            raise ValueError("a robot that goes on needs nobody to make it go on")
        return self


class ScheduleSettings(Settings):
    """A drill's times."""

    begins_at_s: Seconds
    lasts_s: Seconds
    settles_s: Seconds
    """After the fault is over; by then it drives again by itself, or never will."""
    drives_again_s: Seconds
    """After a teacher has said what ends it."""


class StopTimeSettings(Settings):
    """One stop time to measure: a cell of the table, and the goal."""

    what: str
    target: Target
    kind: Kind
    goal_s: Seconds
    """From the cause to the frame on the bus."""


class FaultTable(Settings):
    """All of it: twelve targets, seven kinds each."""

    name: str
    robot: str
    task: str
    action: str
    """What the robot is taught to do in the one situation of the hall."""
    schedule: ScheduleSettings
    envelope: EnvelopeSettings
    stop_times: tuple[StopTimeSettings, ...]
    cases: dict[Target, dict[Kind, CaseSettings]]

    @model_validator(mode="after")
    def _leaves_nothing_to_chance(self) -> Self:
        missing = [f"{target} {kind}" for target in TARGETS for kind in KINDS if kind not in self.cases.get(target, {})]
        if missing:
            raise ValueError(f"cases are missing: {', '.join(missing)}")
        return self


class FaultCase(NamedTuple):
    """A cell of the table."""

    target: Target
    kind: Kind
    must: CaseSettings

    def __str__(self) -> str:
        return f"{self.target} {self.kind}"


def load_faults(name_or_path: str = "kurt2") -> FaultTable:
    """A shipped table by name, or one by path. Raises hal.settings.SettingsError."""
    return load_settings(find_config("faults", name_or_path), FaultTable)


def cases_of(
    table: FaultTable, targets: tuple[Target, ...] = TARGETS, kinds: tuple[Kind, ...] = KINDS
) -> Iterator[FaultCase]:
    """The cases of these targets and kinds, row by row."""
    for target in targets:
        for kind in kinds:
            yield FaultCase(target, kind, table.cases[target][kind])
