"""The table of faults (`table.yaml`): twelve targets, seven kinds, and what the robot must do each time."""

from pathlib import Path
from typing import Annotated, Literal, NamedTuple, Self, get_args

from pydantic import Field, model_validator

from config.settings import Settings, load_settings

RobotKind = Literal["kurt2", "school", "turtlebot"]

_Part = Literal["sensor_board_1", "sensor_board_2", "encoders", "left_motor", "right_motor", "bus_in", "bus_out"]
_DrillTarget = Literal[_Part, "teacher_link", "disk", "clock", "tick", "recorder"]
_DrillKind = Literal["off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent"]

Target = Literal[
    _DrillTarget, "bumpers", "cable", "controller", "stranger", "link", "program", "wall_clock", "serial", "topics"
]
"""Part that fails; bus_in is the direction from robot to notebook, bus_out the opposite one. The last nine fail in
stories only: a stranger is another node on the bus, link the one of the teacher's device."""

_OfMessages = Literal["sound", "lost", "doubled", "reordered", "replayed", "telemetry", "crlf", "stamps"]
_OfParts = Literal["pressed", "jump", "bus_off", "unplugged", "restart", "stranger", "alarm", "full", "read_only"]
_OfPrograms = Literal["keys_renewed", "page_dies", "killed", "killed_before_commit", "killed_after_commit"]
Kind = Literal[_DrillKind, _OfMessages, _OfParts, _OfPrograms, "back", "ahead"]
"""Kind of fault: no output, repeated output, nonsense, plausible but false, rarer, late, on and off; then those that
only stories have. A sound hand is no fault: a second teacher drives."""

LeadsTo = Literal["stands", "asks", "stutters", "drives_on"]
"""Required reaction.

stands: at least until the end of the fault. asks: stands because the situation is unknown. stutters: stands for
moments. drives_on: never stands.
"""

EndsBy = Literal["itself", "resume", "press", "restart"]
"""Condition to drive again after the fault: nothing, a teacher's resume, a new press, a restart with a resume."""

TARGETS: tuple[Target, ...] = get_args(_DrillTarget)
KINDS: tuple[Kind, ...] = get_args(_DrillKind)
"""Targets and kinds of the drills."""

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
    senses_age_s: Seconds
    """Longest silence of one of the range sensors' frames in which wheels may turn."""
    shows_m_s: float
    """Slowest set point that shows whether wheels obey: in a narrow curve one side nearly stands."""
    rest_m_s: float = 0.0
    """Speed of a side that rests: steps of a twist are not those of its sides."""


class Row(Settings):
    """Fault in stories, and why a robot may stand because of it."""

    lasts_s: tuple[float, float] = (0.2, 3.0)
    """Shortest and longest duration in a story, in s."""
    period_s: Seconds = 1.0
    """slow: interval between two outputs, or time constant. intermittent: span of each failure and recovery."""
    delay_s: Seconds = 1.0
    """Delay, or duration of each blocking call."""
    because: str | tuple[str, ...] = ()
    """Guard reason or decision cause of the standstill; any one of several."""
    also: tuple[str, ...] = ()
    """Further reasons of a robot whose other parts fail, too, or whose fault is longer or shorter than in a drill."""
    latches: str | None = None
    """Guard reason of the final latch."""
    latches_within_s: Seconds | None = None

    @property
    def words(self) -> tuple[str, ...]:
        """Accepted reasons of the standstill (`because`) as a tuple; empty for a robot that drives on."""
        return (self.because,) if isinstance(self.because, str) else self.because

    @property
    def reasons(self) -> frozenset[str]:
        """All guard reasons and decision causes of a robot that may stand because of it."""
        return frozenset((*self.words, *self.also, *filter(None, (self.latches,))))

    @property
    def stands_within_s(self) -> float | None:
        """Time after which a robot that drove stands until the end, for good if it latches; None if it need not."""
        return self.latches_within_s


class DrillRow(Row):
    """Fault of one case, and what must come of it in a drill."""

    drill_lasts_s: Seconds | None = None
    """Duration; None: the schedule's."""
    stop_said_after_s: Seconds | None = None
    """Time from the fault to a teacher's stop; None: no stop."""
    leads_to: LeadsTo
    within_s: Seconds | None = None
    """Limit from the fault to the (first) standstill on the robot's end of the bus."""
    ends_by: EndsBy
    counts: str | None = None
    """Counter that must be positive."""
    old_frames: int = 0
    """Allowed set points beyond the age limit on arrival, if frames are delayed after the guard."""
    why: str

    @property
    def stands_within_s(self) -> float | None:
        return (self.latches_within_s or self.within_s) if self.leads_to == "stands" else None

    @model_validator(mode="after")
    def _says_when_it_stands(self) -> Self:
        stands = self.leads_to != "drives_on"
        if stands is not bool(self.because) or stands is (self.within_s is None):
            raise ValueError("because and within_s belong to a robot that stands, and to no other")
        if (self.latches is None) is not (self.latches_within_s is None):
            raise ValueError("latches and latches_within_s belong together")
        return self


class Fault(NamedTuple):
    """Fault of one target for a span of simulated time; `period_s` and `delay_s` as in the table."""

    target: Target
    kind: Kind
    begin_s: float
    end_s: float
    period_s: float = 1.0
    delay_s: float = 1.0

    def __str__(self) -> str:
        return f"{self.target} {self.kind}"

    def acts(self, now_s: float) -> bool:
        """Return whether the fault acts at `now_s`; an intermittent one acts while it fails."""
        if not self.begin_s <= now_s < self.end_s:
            return False
        return self.kind != "intermittent" or int((now_s - self.begin_s) / self.period_s) % 2 == 0


class FaultTable(Settings):
    """Table of twelve targets and seven kinds, and of what only stories have."""

    envelopes: dict[RobotKind, Limits]
    parts: dict[RobotKind, tuple[Target, ...]]
    """Targets that one robot has alone; it has all those that no robot has alone."""
    cases: dict[Target, dict[Kind, DrillRow]]
    stories: dict[Target, dict[Kind, Row]]

    def row(self, target: Target, kind: Kind) -> Row:
        """Return the row of a fault, of drills or of stories alone."""
        return self.cases.get(target, {}).get(kind) or self.stories[target][kind]

    def fault(self, target: Target, kind: Kind, begin_s: float, end_s: float) -> Fault:
        """Return a fault with period and delay of its row."""
        row = self.row(target, kind)
        return Fault(target, kind, begin_s, end_s, row.period_s, row.delay_s)

    def has(self, robot: RobotKind, target: Target) -> bool:
        """Return whether a robot has a target."""
        return all(robot == each or target not in parts for each, parts in self.parts.items())


TABLE = load_settings(Path(__file__).with_name("table.yaml"), FaultTable)
