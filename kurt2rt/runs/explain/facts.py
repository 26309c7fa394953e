"""Facts of one decision as plain values that can be encoded and sent."""

import math
from dataclasses import dataclass
from typing import Annotated

from hal.robot import WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.decision.standing import ActiveStop
from kurt2rt.core.message_fields import Int, Line, Number, OneOf, OrNotFinite, Share, Time, Title, Truth, UpTo, Word
from kurt2rt.core.rla.rla import MID, rla_title

MOST_OTHERS = 12
"""RLAs of a level that are sent in addition to the nearest: the next nearest."""

MOST_FEATURES = 512
PhaseInt = Annotated[int, Int(1, 5)]
Distance = Annotated[Time, OrNotFinite(math.inf)]
Names = Annotated[tuple[Title, ...], UpTo(MOST_FEATURES)]


@dataclass(frozen=True, slots=True)
class LessonFact:
    """Lesson about an RLA, for an explanation: its words, teacher and time, and whether it stands."""

    text: Line
    """Lesson in words, such as: RLA 17 corrected: forward instead of spin_left."""
    teacher: Title
    phase: PhaseInt
    tick: Number
    """Tick number in the run in which it was taught."""
    stamp: Title
    """UTC time of writing, ISO 8601; empty if unknown."""
    undone: Truth = False
    changes: Truth = True
    """True if the lesson is part of the present action: not undone and no reward."""


@dataclass(frozen=True, slots=True)
class RlaFacts:
    """Facts on one RLA of an explained decision: action, distance, lessons, uses and rewards."""

    rla_id: Number
    title: Title
    action: Title
    condition: Annotated[tuple[Time, ...], UpTo(MOST_FEATURES)]
    """Shape (d,)."""
    distance: Distance
    """Weighted distance to the situation of the decision; infinite if the robot did not know its place."""
    radius: Time
    acts: Annotated[tuple[LessonFact, ...], UpTo(32)]
    """Oldest first."""
    uses: Number
    """Number of times it started to drive since it was first taught."""
    rewards: Number
    punishments: Number
    value: Time | None
    """Value learnt from rewards; None without rewards."""
    asks: Truth
    """True if its action was withdrawn."""
    leads: Truth = True
    """True if it is the one that answers among the RLAs on its condition."""
    image: Word = ""
    """Image in which it is compared, by which its action and condition are told."""

    @property
    def name(self) -> str:
        """Return its short name for columns: RLA 17, or RLA 17 mirrored."""
        return rla_title(self.rla_id, "", image=self.image)


@dataclass(frozen=True, slots=True)
class LevelFacts:
    """Facts on one level in one tick: its situation, and the RLAs that were compared with it."""

    level: Title
    behaviour: Title
    """Taught behaviour whose RLAs competed; empty if there is only one."""
    names: Names
    """Feature names, shape (d,)."""
    vector: Annotated[tuple[Annotated[Time, OrNotFinite(math.nan)], ...], UpTo(MOST_FEATURES)]
    """Situation, shape (d,)."""
    weights: Annotated[tuple[Time, ...], UpTo(MOST_FEATURES)]
    """Weight of each feature in a distance, shape (d,)."""
    euclidean: Truth
    """False for symbols: a distance counts the places that differ."""
    nearest: RlaFacts | None
    """None before the first lesson."""
    driver: RlaFacts | None
    """RLA whose action was followed; None if there was none."""
    others: Annotated[tuple[RlaFacts, ...], UpTo(MOST_OTHERS)]
    """RLAs after the nearest in order of distance; the first is the runner-up."""
    count: Number
    """Number of RLAs that competed."""
    words: Names = ()
    """Situation in words; empty if the level has none."""
    nearest_words: Names = ()
    """Condition of the nearest RLA in words."""
    radius_share: Share = 1.0
    """Fraction of R within which RLAs answer; below 1 while the robot is taught and asks sooner."""
    passed_over: RlaFacts | None = None
    """RLA nearer than the nearest, which does not answer because no teacher can be asked; None without one."""

    @property
    def runner_up(self) -> RlaFacts | None:
        """Second nearest RLA; None without one."""
        return self.others[0] if self.others else None

    @property
    def otherwise(self) -> RlaFacts | None:
        """Nearest RLA with another action than the nearest of all; None if none is known."""
        if self.nearest is None:
            return None
        return next((other for other in self.others if other.action != self.nearest.action), None)

    @property
    def lost(self) -> bool:
        """Return whether the robot does not know its place."""
        return any(math.isnan(value) for value in self.vector)

    @property
    def leader(self) -> RlaFacts | None:
        """RLA that answers among those on the nearest condition; None if nothing was taught."""
        nearest = self.nearest
        if nearest is None or nearest.leads:
            return nearest
        same = (other for other in self.others if other.leads and other.condition == nearest.condition)
        return next(same, nearest)

    def contrast_of(self, rla: RlaFacts) -> RlaFacts | None:
        """Return the RLA to compare with: the nearest, or for the nearest its closest rival; None without one."""
        if self.nearest is not None and self.nearest.condition != rla.condition:
            return self.nearest
        return self.otherwise or self.runner_up


@dataclass(frozen=True, slots=True)
class ContactFacts:
    """Remembered obstacle that an action would meet, as a cause of the robot's doubt."""

    action: Title
    within_s: Time
    """Time until the outline would meet the obstacle."""
    sensor: Title
    """Position and name of the sensor that saw the obstacle, such as `front left (s9)`."""
    seen_s: Time
    """Age of that look, in s of driving."""


@dataclass(frozen=True, slots=True)
class DoubtFacts:
    """Doubt about the action of the nearest RLA, and the sensor that causes most of it."""

    score: Time
    threshold: Time
    """Score from which the robot asks."""
    sensor: Title = ""
    """Position of the sensor ahead that sees an obstacle nearer than lessons that drive on; empty without one."""
    reads: Title = ""
    """Its reading in words, such as 13 cm."""
    taught: Title = ""
    """Reading that all such lessons but at most one reach or stay beyond, in words."""
    contact: ContactFacts | None = None
    """Remembered obstacle that the action would meet; None without one."""


@dataclass(frozen=True, slots=True)
class DecisionFacts:
    """Facts on the decision of one tick, from which page, terminal and `kurt2rt why` explain it."""

    tick: Number
    now_s: Time
    """Time of the runtime's clock."""
    robot: Title
    task: Title
    phase: PhaseInt
    cause: Annotated[str, OneOf(tuple(cause.value for cause in DecisionCause))]
    """A value of kurt2rt.core.decision.decision.DecisionCause."""
    action: Title | None
    """Action that drove; None if the robot stood."""
    asks_at: Title
    """Level that asked, if one did."""
    decided: WheelSpeeds
    granted: WheelSpeeds
    reasons: Names
    """Reasons of the guard for changing the decision."""
    latched: Truth
    """True if the guard kept the robot stopped."""
    stopped: ActiveStop | None
    """Stop that holds until a teacher resumes; None without one."""
    trouble: Line
    """Reason why lessons could not be saved; empty if they could."""
    teacher: Title
    """Present teacher; empty without one."""
    infrared_counts: Annotated[tuple[Number, ...], UpTo(64)]
    """Counts that the robot decided by; those of broken sensors come from their neighbours."""
    infrared_age_s: Distance
    basic: LevelFacts
    mid: LevelFacts | None
    """None if the task has no mid level."""
    overridden: Truth
    """True if a teacher commanded the behaviour instead of the mid level."""
    plan_says: Line
    """Status of the goal in words; empty without one."""
    kept: Title = ""
    """Action held for its minimum time, which no other action could replace; empty if none was."""
    history_frozen: Truth = True
    """True if the averages of the situation were not updated."""
    taught_now: Truth = False
    """True if a lesson was applied in this tick."""
    broken_sensors: Names = ()
    """Infra-red sensors that do not count, by position and name, such as `front left edge (s15)`."""
    hindrances: Names = ()
    """Causes that would have stopped the robot without a stop or manual driving: values of DecisionCause."""
    doubt: DoubtFacts | None = None
    """None if the robot has no score of doubt, and at a standstill for another reason."""
    lesson_speed: Share = 1.0
    """Fraction of the decided speeds that was asked of the guard; below 1 in a slow lesson."""

    @property
    def deciding(self) -> tuple[LevelFacts, RlaFacts | None]:
        """Level that decided, and its RLA that was followed or is nearest."""
        if self.asks_at == MID and self.mid is not None:
            return self.mid, self.mid.nearest
        return self.basic, self.basic.driver or self.basic.nearest
