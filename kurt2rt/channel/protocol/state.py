"""State of the robot, published 20 times a second."""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

from pydantic import Field

from kurt2rt.channel.protocol.limits import BOOT_BYTES
from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.core.decision.standing import ActiveStop, Standing
from kurt2rt.core.message_fields import Bytes, Finite, Int, Line, Number, OneOf, Real, Share, Truth, UpTo, Word
from kurt2rt.core.progress import NO_PROGRESS, Progress
from kurt2rt.core.rla.rla import BASIC, Phase
from kurt2rt.core.teaching.message_fields import MOST_SEGMENTS, Level
from kurt2rt.core.teaching.question import FeatureDifference
from simbridge.contracts.simulation import SimulatedPlace

MOST_STEPS = 32
"""Most steps of a plan; a longer plan is cut."""
Symbols = Annotated[tuple[Word, ...], UpTo(32)]
Segments = Annotated[tuple[Number, ...], UpTo(MOST_SEGMENTS)]


class MidState(NamedTuple):
    """Command of the mid level to the basic level, with its reason."""

    behaviour: Word
    """Taught behaviour that is followed."""
    rla: Number | None
    """Mid-level RLA that commands; None while the level asks, under an override, or before the first command."""
    nearest: Number | None
    """Mid-level RLA nearest to the situation; None before the first."""
    nearest_behaviour: Word | None
    distance: Real
    """Distance of the nearest RLA, such as the number of differing symbols; infinite without RLA."""
    radius: Real
    taught_by: Word
    """Teacher of the nearest RLA's behaviour; empty without RLA."""
    taught_at: Word
    """Time of that lesson, UTC, ISO 8601; empty without RLA, or while the lesson is not durable."""
    asks: Truth
    """True while the robot stands because the mid level does not know its situation."""
    overridden: Truth
    """True while a teacher's choice overrides the level, until the behaviour has finished."""
    here: Symbols
    """Situation of the mid level in words, the newest symbol first; empty words: no symbol yet."""
    there: Symbols
    """Condition of the nearest RLA in words, in the same order; empty without RLA."""


class SurpriseState(NamedTuple):
    """Newest surprise: a situation after an RLA that differs from the expectation learnt for its end."""

    tick: Number
    level: Level
    rla: Number
    """RLA with the expectation."""
    follow_up: Number
    """RLA that followed it."""
    times: Real
    """Distance from the expectation, in multiples of its usual distance."""
    new: Truth
    """True if `follow_up` had never followed `rla` before."""


class HoldState(NamedTuple):
    """Newest press of an action's button, held to correct; its lessons can be undone together."""

    teacher: Word
    action: Word
    """Action that is held, or was held last."""
    lesson: Word
    """Id that undoes all lessons of the press."""
    lessons: Number
    """Number of lessons that it gave."""
    on: Truth
    """True while the action drives."""


class ShownState(NamedTuple):
    """Newest drive by hand that can still be taught, cut into segments of the nearest actions."""

    teacher: Word
    press_id: Number
    """Press that was driven; a confirmation names it."""
    actions: Annotated[tuple[Word, ...], UpTo(MOST_SEGMENTS)]
    """Action of each segment."""
    from_ticks: Segments
    """First tick of each segment."""
    ticks: Segments
    """Length of each segment in ticks."""


@dataclass(frozen=True, slots=True)
class State:
    """State of the robot at one tick. Commands name the tick of the state that the teacher saw."""

    boot: Annotated[bytes, Bytes(BOOT_BYTES), Field(alias="b")]
    """Four random bytes of this start of the robot program."""
    tick: Annotated[Number, Field(alias="t")]
    phase: Annotated[int, Int(1, 5), Field(alias="ph")]
    infrared_counts: Annotated[tuple[Annotated[int, Int(0, 65_535)], ...], UpTo(64), Field(alias="ir")]
    """Counts in the order of the sensor table; high is near."""
    infrared_age_s: Annotated[Real, Field(alias="ia")]
    """Age of the readings in seconds; infinite before the first frame."""
    bumpers: Annotated[int, Int(0, 2**32 - 1), Field(alias="bp")]
    """Bit n set: bumper n is pressed."""
    left_m_s: Annotated[Finite, Field(alias="ml")]
    """Set points that went out, after the guard."""
    right_m_s: Annotated[Finite, Field(alias="mr")]
    cause: Annotated[Word, Field(alias="by")]
    """Mover of the wheels, or reason of the standstill: a value of kurt2rt.core.decision.decision.DecisionCause."""
    action: Annotated[Word | None, Field(alias="act")]
    """Action that drives; None while the robot stands."""
    rla: Annotated[Number | None, Field(alias="rla")]
    """RLA that drives; None while the robot stands or a teacher drives."""
    nearest: Annotated[Number | None, Field(alias="n")]
    """RLA nearest to the situation; None before the first lesson."""
    nearest_action: Annotated[Word | None, Field(alias="na")]
    distance: Annotated[Real, Field(alias="d")]
    """Distance of the nearest RLA; infinite without RLA."""
    radius: Annotated[Real, Field(alias="r")]
    taught_by: Annotated[Word, Field(alias="tb")]
    """Teacher of the nearest RLA's action; empty without RLA."""
    taught_at: Annotated[Word, Field(alias="ta")]
    """Time of that lesson, UTC, ISO 8601; empty without RLA, or while the lesson is not durable."""
    question: Annotated[tuple[FeatureDifference, ...], UpTo(32), Field(alias="ask")]
    """Features that differ most from the nearest RLA, largest first; empty unless the robot asks."""
    teacher: Annotated[Word | None, Field(alias="who")]
    """Present teacher; None without teacher."""
    by_hand: Annotated[Truth, Field(alias="hand")]
    """True while the teacher drives by hand or runs an action."""
    stopped: Annotated[ActiveStop | None, Field(alias="sr")]
    """Stop that holds until GO; None without stop."""
    rlas: Annotated[Number, Field(alias="nr")]
    lessons: Annotated[Number, Field(alias="nl")]
    """Number of lessons that stand, rewards included."""
    unsaved: Annotated[Number, Field(alias="un")]
    """Number of lessons that are not durable yet."""
    session: Annotated[Word | None, Field(alias="ses")]
    """Name of the present session; None without session."""
    clock_s: Annotated[Finite, Field(alias="clk")]
    """Teaching time of the present session, or of the last one, in seconds."""
    guard: Annotated[tuple[Line, ...], UpTo(16), Field(alias="g")]
    """Reasons why the guard reduced the wanted speeds."""
    trouble: Annotated[Line, Field(alias="tr")]
    """Fault of disk or bus in a line; empty without fault."""
    late_p99_ms: Annotated[Real, Field(alias="lp")]
    """Lateness of ticks, 99th percentile of the last minute, in milliseconds."""
    missed_ticks: Annotated[Number, Field(alias="ms")]
    place: Annotated[SimulatedPlace | None, Field(alias="pl")]
    standing: Annotated[Standing, Field(alias="sd")]
    """Reason of the standstill, or that the robot drives."""
    way_m: Annotated[tuple[Finite, Finite], Field(alias="od")]
    """Way of the left and right side by the encoders since the program started, in m, forward positive."""
    behaviour: Annotated[Word, Field(alias="w")] = ""
    """Selected taught behaviour; empty if the task has only one."""
    value: Annotated[Finite | None, Field(alias="v")] = None
    """Learnt value of the driving RLA's action; None while no RLA drives."""
    opinion: Annotated[Annotated[int, OneOf((-1, 0, 1))] | None, Field(alias="op")] = None
    """Critic's appraisal of this situation: -1, 0 or +1; None without one."""
    opinion_of: Annotated[Number | None, Field(alias="on")] = None
    """Appraisal RLA behind the opinion."""
    agreement: Annotated[Share | None, Field(alias="ag")] = None
    """Fraction of the teacher's latest rewards that the critic agreed with; None while there are too few."""
    trusted: Annotated[Truth, Field(alias="tru")] = False
    """True if the critic agrees well enough to act in phase 5."""
    role: Annotated[Word, Field(alias="cr")] = "listens"
    """State of the critic: a value of kurt2rt.core.critic.critic.CriticState."""
    bad_share: Annotated[Share | None, Field(alias="bs")] = None
    """Fraction of the driven time that the critic found bad lately; None while it only listens."""
    signals_missing: Annotated[tuple[Number, Number], Field(alias="sm")] = (0, 0)
    """Numbers of -1 and +1 rewards that are missing before the agreement is known."""
    asks_at: Annotated[Level, Field(alias="aa")] = BASIC
    """Level that does not know its situation, BASIC or MID; nearest, distance and radius are of that level."""
    mid: Annotated[MidState | None, Field(alias="mid")] = None
    """None if the robot has no mid level."""
    surprise: Annotated[SurpriseState | None, Field(alias="su")] = None
    """Latest surprise; None before the first."""
    goal: Annotated[Word, Field(alias="go")] = ""
    """Goal in words; empty without goal."""
    plan: Annotated[tuple[Word, ...], UpTo(MOST_STEPS), Field(alias="pn")] = ()
    """Behaviours that lead to the goal, the next one first."""
    plan_says: Annotated[Line, Field(alias="ps")] = ""
    """Status of the plan in a line; empty without goal."""
    image: Annotated[Word, Field(alias="im")] = ""
    """Image in which the RLA drives, such as `mirrored`; empty for none."""
    nearest_image: Annotated[Word, Field(alias="ni")] = ""
    """Image in which the nearest RLA is near, which `nearest_action` is of."""
    nearest_value: Annotated[Finite | None, Field(alias="nv")] = None
    """Value of the nearest RLA when its action was withdrawn; None if it has its action."""
    progress: Annotated[Progress, Field(alias="pg")] = NO_PROGRESS
    """Fraction driven by RLAs, and the questions, in the last minute."""
    hold: Annotated[HoldState | None, Field(alias="hd")] = None
    """Newest hold; None before the first."""
    doubt: Annotated[Finite | None, Field(alias="db")] = None
    """Doubt about the action that drives, or would; None if the robot has no score of doubt, or stands otherwise."""
    shown: Annotated[ShownState | None, Field(alias="dm")] = None
    """Newest drive by hand that can be taught; None without one."""
    lesson_speed: Annotated[Share, Field(alias="ls")] = 1.0
    """Fraction of their speed at which actions drive in phases 1 and 2, from 0.2; 1 is no slow lesson."""

    @property
    def speed_share(self) -> float:
        """Fraction of their speed at which actions drive in the present phase."""
        return self.lesson_speed if self.phase <= Phase.CORRECTIONS else 1.0


STATE = Codec[State]("state", State)
