"""The table of faults (`table.yaml`): twelve targets, seven kinds, and what the robot must do each time."""

from pathlib import Path
from typing import Annotated, Literal, NamedTuple, Self, get_args

from pydantic import Field, model_validator

from config.settings import Settings, load_settings

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


class Limits(Settings):
    """Limits of every moving frame, written down a second time, independent of the guard's."""

    speed_m_s: float
    acceleration_m_s2: float
    braking_m_s2: float
    resolution_m_s: float
    longest_step_s: Seconds
    """Longest step in which speed may change, also after a brake, when the guard starts at its last set point."""
    command_age_s: Seconds
    controller_watchdog_s: Seconds


class Row(Settings):
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
    old_frames: int = 0
    """Allowed set points beyond the age limit on arrival, if frames are delayed after the guard."""
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
        return self


class Schedule(Settings):
    """Times of a drill."""

    begins_at_s: Seconds
    lasts_s: Seconds
    settles_s: Seconds
    """Time after the fault in which the robot may drive again by itself."""
    drives_again_s: Seconds
    """Time to drive again after the teacher's command."""


class FaultTable(Settings):
    """Table of twelve targets and seven kinds."""

    schedule: Schedule
    envelope: Limits
    cases: dict[Target, dict[Kind, Row]]


class Case(NamedTuple):
    """Cell of the table."""

    target: Target
    kind: Kind
    must: Row

    def __str__(self) -> str:
        return f"{self.target} {self.kind}"


TABLE = load_settings(Path(__file__).with_name("table.yaml"), FaultTable)
CASES = tuple(Case(target, kind, row) for target, rows in TABLE.cases.items() for kind, row in rows.items())


def case_of(target: Target, kind: Kind) -> Case:
    return Case(target, kind, TABLE.cases[target][kind])
