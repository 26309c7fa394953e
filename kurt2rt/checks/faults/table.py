"""Schema of `config/faults/*.yaml`: faults and the required reaction of the robot."""

from collections.abc import Iterator
from typing import Annotated, Literal, NamedTuple, Self, get_args

from pydantic import Field, model_validator

from hal.settings import Settings, load_settings
from hal.settings_files import find_config

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
"""Part that fails; bus_in is the direction from robot to notebook, bus_out the opposite one."""

Kind = Literal["off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent"]
"""Kind of fault: no output, repeated output, nonsense, plausible but false, rarer, late, on and off."""

LeadsTo = Literal["stands", "asks", "stutters", "drives_on"]
"""Required reaction.

stands: at least until the end of the fault. asks: stands because the situation is unknown. stutters: stands for
moments. drives_on: never stands.
"""

EndsBy = Literal["itself", "resume", "press", "restart"]
"""Condition to drive again after the fault: nothing, a teacher's resume, a new press, a restart with a resume."""

TARGETS: tuple[Target, ...] = get_args(Target)
KINDS: tuple[Kind, ...] = get_args(Kind)

Seconds = Annotated[float, Field(gt=0, le=10)]


class EnvelopeSettings(Settings):
    """Limits of every moving frame, written down a second time, independent of the guard's."""

    speed_m_s: Annotated[float, Field(gt=0, le=3)]
    acceleration_m_s2: Annotated[float, Field(gt=0, le=20)]
    braking_m_s2: Annotated[float, Field(gt=0, le=20)]
    resolution_m_s: Annotated[float, Field(gt=0, le=0.1)]
    longest_step_s: Seconds
    """Longest step in which speed may change, also after a brake, when the guard starts at its last set point."""
    command_age_s: Seconds
    controller_watchdog_s: Seconds


class CaseSettings(Settings):
    """Fault of one case and the required reaction."""

    period_s: Seconds = 1.0
    """slow: interval between two outputs, or time constant. intermittent: span of each failure and recovery."""
    delay_s: Seconds = 1.0
    """Delay, or duration of each blocking call."""
    lasts_s: Seconds | None = None
    """Duration; None: the schedule's."""
    stop_said_after_s: Seconds | None = None
    """Time from the fault to a teacher's stop; None: no stop."""
    leads_to: LeadsTo
    because: str | tuple[str, ...] = ()
    """Guard reason or decision cause of the standstill; any one of several."""
    within_s: Seconds | None = None
    """Limit from the fault to the (first) standstill on the robot's end of the bus."""
    latches: str | None = None
    """Guard reason of the final latch."""
    latches_within_s: Seconds | None = None
    ends_by: EndsBy
    counts: str | None = None
    """Counter that must be positive."""
    old_frames: Annotated[int, Field(ge=0, le=10)] = 0
    """Allowed set points beyond the age limit on arrival, if frames are delayed after the guard."""
    slew_share: Annotated[float, Field(ge=1, le=3)] = 1.0
    """Allowed multiple of the slew limit, if the clock that measures slew is faulty."""
    known_gap: str | None = None
    """Known deviation and its reason; the row fails once the deviation is gone."""
    why: str

    @property
    def words(self) -> tuple[str, ...]:
        """Accepted reasons of the standstill (`because`) as a tuple; empty for a robot that drives on."""
        return (self.because,) if isinstance(self.because, str) else self.because

    @model_validator(mode="after")
    def _says_when_it_stands(self) -> Self:
        stands = self.leads_to != "drives_on"
        if stands is not bool(self.because) or stands is (self.within_s is None):
            raise ValueError("because and within_s belong to a robot that stands, and to no other")
        if (self.latches is None) is not (self.latches_within_s is None):
            raise ValueError("latches and latches_within_s belong together")
        if self.leads_to in ("drives_on", "stutters") and (self.ends_by != "itself" or self.latches):
            raise ValueError("a robot that goes on needs no command to go on")
        return self


class ScheduleSettings(Settings):
    """Times of a scenario."""

    begins_at_s: Seconds
    lasts_s: Seconds
    settles_s: Seconds
    """Time after the fault in which the robot may drive again by itself."""
    drives_again_s: Seconds
    """Time to drive again after the teacher's command."""


class StopTimeSettings(Settings):
    """Stop time to measure: a cell of the table, and the goal."""

    what: str
    target: Target
    kind: Kind
    goal_s: Seconds
    """Limit from the cause to the frame on the bus."""


class FaultTable(Settings):
    """Table of twelve targets and seven kinds."""

    name: str
    robot: str
    task: str
    action: str
    """Action taught for the corridor's only situation."""
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
    """Cell of the table."""

    target: Target
    kind: Kind
    must: CaseSettings

    def __str__(self) -> str:
        return f"{self.target} {self.kind}"


def load_faults(name_or_path: str = "kurt2") -> FaultTable:
    """Load a shipped table by name, or one by path. Raises SettingsError."""
    return load_settings(find_config("faults", name_or_path), FaultTable)


def cases_of(
    table: FaultTable, targets: tuple[Target, ...] = TARGETS, kinds: tuple[Kind, ...] = KINDS
) -> Iterator[FaultCase]:
    """Yield the cases of these targets and kinds, row by row."""
    for target in targets:
        for kind in kinds:
            yield FaultCase(target, kind, table.cases[target][kind])
