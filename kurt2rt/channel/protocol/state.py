"""What the robot tells its teachers, 20 times a second."""

from dataclasses import dataclass

from hal.simulation import SimulatedPlace
from kurt2rt.core.decision.active_stop import ActiveStop
from kurt2rt.core.decision.standing import DRIVES, Standing, standing_for
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.progress import NO_PROGRESS, Progress
from kurt2rt.core.teaching.question import FeatureDifference


@dataclass(frozen=True, slots=True)
class MidState:
    """What the mid level wants of the basic one, and why."""

    behaviour: str
    """The taught behaviour that is followed now."""
    rla: int | None
    """Mid-level RLA that commands; None while it asks, or a teacher or nobody has said what to follow."""
    nearest: int | None
    """Mid-level RLA nearest to what the robot has come by; None before the first."""
    nearest_behaviour: str | None
    distance: float
    """Of the nearest one, such as how many symbols differ; infinite without one."""
    radius: float
    taught_by: str
    """Who taught the nearest one's behaviour; empty without one."""
    taught_at: str
    """When, UTC, ISO 8601; empty without one, or while it is not durable yet."""
    asks: bool
    """Whether the robot stands because the mid level does not know what to follow."""
    overridden: bool
    """Whether a teacher's choice counts in its place, until the behaviour has finished."""
    here: tuple[str, ...]
    """The mid level's situation in words, the newest symbol first; empty words are none yet."""
    there: tuple[str, ...]
    """The nearest one's condition, word by word beside it; empty without one."""


@dataclass(frozen=True, slots=True)
class SurpriseState:
    """Something else came than an RLA has learnt to expect."""

    tick: int
    """When."""
    level: str
    rla: int
    """Whose expectation it was."""
    follow_up: int
    """The RLA that took over."""
    times: float
    """Distance of what came from what was expected, in its usual ones: 1 is usual."""
    new: bool
    """Whether this RLA had never been followed by that one."""


@dataclass(frozen=True, slots=True)
class State:
    """One picture of the robot. What a teacher does is told with the tick of the picture he did it on."""

    boot: bytes
    """Four random bytes of this start of the robot program."""
    tick: int
    phase: int
    infrared_counts: tuple[int, ...]
    """In the order of the sensor table; high is near."""
    infrared_age_s: float
    """Infinite before the first frame."""
    bumpers: int
    """Bit n set: bumper n is pressed."""
    left_m_s: float
    """Set points that went out, after the guard."""
    right_m_s: float
    cause: str
    """Who moves the wheels, or why they stand: a value of kurt2rt.core.decision.decision.Cause."""
    action: str | None
    """Action that drives; None while the robot stands."""
    rla: int | None
    """RLA that drives; None while the robot stands or a teacher drives."""
    nearest: int | None
    """RLA nearest to the situation; None before the first lesson."""
    nearest_action: str | None
    distance: float
    """Of the nearest RLA; infinite without one."""
    radius: float
    taught_by: str
    """Who taught the nearest RLA's action; empty without one."""
    taught_at: str
    """When, UTC, ISO 8601; empty without one, or while it is not durable yet."""
    question: tuple[FeatureDifference, ...]
    """While the robot asks: the features that differ most from the nearest RLA, most first."""
    teacher: str | None
    """Who teaches; None while nobody does."""
    by_hand: bool
    """Whether that one drives by hand or runs a behaviour just now."""
    stopped: ActiveStop | None
    """The stop that holds until Go; None while none does."""
    rlas: int
    lessons: int
    """Lessons that stand, rewards among them."""
    unsaved: int
    """Lessons that are not durable yet."""
    session: str | None
    """Name of the session that is on."""
    clock_s: float
    """Teaching time of that session, or of the last one."""
    guard: tuple[str, ...]
    """Why the guard let through less than was wanted."""
    trouble: str
    """What is wrong with disk or bus, in a line; empty when nothing is."""
    late_p99_ms: float
    """How late ticks begin, 99th percentile of the last minute."""
    missed_ticks: int
    place: SimulatedPlace | None
    behaviour: str = ""
    """The taught behaviour that is wanted; empty where the task has only one."""
    value: float | None = None
    """What the action of the RLA that drives is worth, as rewards have taught; None while none drives."""
    opinion: int | None = None
    """What the critic thinks of this situation: -1, 0 or +1; None where it has no opinion."""
    opinion_of: int | None = None
    """The appraisal RLA that thinks so."""
    agreement: float | None = None
    """Share of the teacher's latest signals that the critic had thought, too; None while too few were heard."""
    trusted: bool = False
    """Whether the critic agrees well enough to act in phase 5."""
    role: str = "listens"
    """What the critic does: a value of kurt2rt.core.critic.state.CriticState."""
    bad_share: float | None = None
    """Share of the driven time that it found bad lately; None while it only listens."""
    signals_missing: tuple[int, int] = (0, 0)
    """How many bad and how many good signals the teacher still has to give before agreement is known."""
    asks_at: str = BASIC
    """The level that does not know its situation, where one does not: BASIC or MID. Nearest, distance and radius are of
    that level.
    """
    mid: MidState | None = None
    """None where the robot has no mid level."""
    surprise: SurpriseState | None = None
    """The latest one that is worth telling; None before the first."""
    goal: str = ""
    """What the robot seeks, in words; empty while it seeks nothing."""
    plan: tuple[str, ...] = ()
    """The behaviours that lead there, the next one first."""
    plan_says: str = ""
    """How far the plan is, or why there is none, in a line; empty without a goal."""
    nearest_value: float | None = None
    """Value of the nearest RLA when its action was withdrawn; None if it has its action."""
    progress: Progress = NO_PROGRESS
    """Share driven by the robot itself, and its questions, in the last minute."""
    standing: Standing | None = None
    """None from a robot that is too old to tell."""

    @property
    def stands(self) -> Standing:
        """Whether the robot drives, and if not why."""
        if self.standing is not None:
            return self.standing
        if self.action is not None and (self.by_hand or self.stopped is None):
            return DRIVES
        return standing_for(self.cause, self.asks_at, self.stopped, self.plan_says or self.trouble)
