"""State of the robot, published 20 times a second."""

from dataclasses import dataclass

from kurt2rt.core.decision.active_stop import ActiveStop
from kurt2rt.core.decision.standing import Standing
from kurt2rt.core.rla.rla import BASIC, Phase
from kurt2rt.core.teaching.progress import NO_PROGRESS, Progress
from kurt2rt.core.teaching.question import FeatureDifference
from simbridge.contracts.simulation import SimulatedPlace


@dataclass(frozen=True, slots=True)
class MidState:
    """Command of the mid level to the basic level, with its reason."""

    behaviour: str
    """Taught behaviour that is followed."""
    rla: int | None
    """Mid-level RLA that commands; None while the level asks, under an override, or before the first command."""
    nearest: int | None
    """Mid-level RLA nearest to the situation; None before the first."""
    nearest_behaviour: str | None
    distance: float
    """Distance of the nearest RLA, such as the number of differing symbols; infinite without RLA."""
    radius: float
    taught_by: str
    """Teacher of the nearest RLA's behaviour; empty without RLA."""
    taught_at: str
    """Time of that lesson, UTC, ISO 8601; empty without RLA, or while the lesson is not durable."""
    asks: bool
    """True while the robot stands because the mid level does not know its situation."""
    overridden: bool
    """True while a teacher's choice overrides the level, until the behaviour has finished."""
    here: tuple[str, ...]
    """Situation of the mid level in words, the newest symbol first; empty words: no symbol yet."""
    there: tuple[str, ...]
    """Condition of the nearest RLA in words, in the same order; empty without RLA."""


@dataclass(frozen=True, slots=True)
class SurpriseState:
    """Situation that differs from the learnt expectation of an RLA."""

    tick: int
    level: str
    rla: int
    """RLA with the expectation."""
    follow_up: int
    """RLA that followed it."""
    times: float
    """Distance from the expectation, in multiples of its usual distance."""
    new: bool
    """True if `follow_up` had never followed `rla` before."""


@dataclass(frozen=True, slots=True)
class HoldState:
    """Newest press of a held action."""

    teacher: str
    action: str
    """Action that is held, or was held last."""
    lesson: str
    """Id that undoes all lessons of the press."""
    lessons: int
    """Number of lessons that it gave."""
    on: bool
    """True while the action drives."""


@dataclass(frozen=True, slots=True)
class ShownState:
    """Newest drive by hand that was not taught yet, as segments of the nearest actions, oldest first."""

    teacher: str
    press_id: int
    """Press that was driven; a confirmation names it."""
    actions: tuple[str, ...]
    """Action of each segment."""
    from_ticks: tuple[int, ...]
    """First tick of each segment."""
    ticks: tuple[int, ...]
    """Length of each segment in ticks."""


@dataclass(frozen=True, slots=True)
class State:
    """State of the robot at one tick. Commands name the tick of the state that the teacher saw."""

    boot: bytes
    """Four random bytes of this start of the robot program."""
    tick: int
    phase: int
    infrared_counts: tuple[int, ...]
    """Counts in the order of the sensor table; high is near."""
    infrared_age_s: float
    """Age of the readings in seconds; infinite before the first frame."""
    bumpers: int
    """Bit n set: bumper n is pressed."""
    left_m_s: float
    """Set points that went out, after the guard."""
    right_m_s: float
    cause: str
    """Mover of the wheels, or reason of the standstill: a value of kurt2rt.core.decision.decision.DecisionCause."""
    action: str | None
    """Action that drives; None while the robot stands."""
    rla: int | None
    """RLA that drives; None while the robot stands or a teacher drives."""
    nearest: int | None
    """RLA nearest to the situation; None before the first lesson."""
    nearest_action: str | None
    distance: float
    """Distance of the nearest RLA; infinite without RLA."""
    radius: float
    taught_by: str
    """Teacher of the nearest RLA's action; empty without RLA."""
    taught_at: str
    """Time of that lesson, UTC, ISO 8601; empty without RLA, or while the lesson is not durable."""
    question: tuple[FeatureDifference, ...]
    """Features that differ most from the nearest RLA, largest first; empty unless the robot asks."""
    teacher: str | None
    """Present teacher; None without teacher."""
    by_hand: bool
    """True while the teacher drives by hand or runs an action."""
    stopped: ActiveStop | None
    """Stop that holds until GO; None without stop."""
    rlas: int
    lessons: int
    """Number of lessons that stand, rewards included."""
    unsaved: int
    """Number of lessons that are not durable yet."""
    session: str | None
    """Name of the present session; None without session."""
    clock_s: float
    """Teaching time of the present session, or of the last one, in seconds."""
    guard: tuple[str, ...]
    """Reasons why the guard reduced the wanted speeds."""
    trouble: str
    """Fault of disk or bus in a line; empty without fault."""
    late_p99_ms: float
    """Lateness of ticks, 99th percentile of the last minute, in milliseconds."""
    missed_ticks: int
    place: SimulatedPlace | None
    standing: Standing
    """Reason of the standstill, or that the robot drives."""
    way_m: tuple[float, float]
    """Way of the left and right side by the encoders since the program started, in m, forward positive."""
    behaviour: str = ""
    """Selected taught behaviour; empty if the task has only one."""
    value: float | None = None
    """Learnt value of the driving RLA's action; None while no RLA drives."""
    opinion: int | None = None
    """Critic's appraisal of this situation: -1, 0 or +1; None without one."""
    opinion_of: int | None = None
    """Appraisal RLA behind the opinion."""
    agreement: float | None = None
    """Fraction of the teacher's latest rewards that the critic agreed with; None while there are too few."""
    trusted: bool = False
    """True if the critic agrees well enough to act in phase 5."""
    role: str = "listens"
    """State of the critic: a value of kurt2rt.core.critic.critic.CriticState."""
    bad_share: float | None = None
    """Fraction of the driven time that the critic found bad lately; None while it only listens."""
    signals_missing: tuple[int, int] = (0, 0)
    """Numbers of -1 and +1 rewards that are missing before the agreement is known."""
    asks_at: str = BASIC
    """Level that does not know its situation, BASIC or MID; nearest, distance and radius are of that level."""
    mid: MidState | None = None
    """None if the robot has no mid level."""
    surprise: SurpriseState | None = None
    """Latest surprise; None before the first."""
    goal: str = ""
    """Goal in words; empty without goal."""
    plan: tuple[str, ...] = ()
    """Behaviours that lead to the goal, the next one first."""
    plan_says: str = ""
    """Status of the plan in a line; empty without goal."""
    nearest_value: float | None = None
    """Value of the nearest RLA when its action was withdrawn; None if it has its action."""
    progress: Progress = NO_PROGRESS
    """Fraction driven by RLAs, and the questions, in the last minute."""
    hold: HoldState | None = None
    """Newest hold; None before the first."""
    doubt: float | None = None
    """Doubt about the action that drives, or would; None if the robot has no score of doubt, or stands otherwise."""
    shown: ShownState | None = None
    """Newest drive by hand that can be taught; None without one."""
    lesson_speed: float = 1.0
    """Fraction of their speed at which actions drive in phases 1 and 2, from 0.2; 1 is no slow lesson."""

    @property
    def speed_share(self) -> float:
        """Fraction of their speed at which actions drive in the present phase."""
        return self.lesson_speed if self.phase <= Phase.CORRECTIONS else 1.0
