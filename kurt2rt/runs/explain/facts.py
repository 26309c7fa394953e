"""What is known of one decision: all that an explanation is made of, as plain values that can be sent elsewhere."""

import math
from dataclasses import dataclass

from hal.robot import WheelSpeeds
from kurt2rt.core.decision.active_stop import ActiveStop
from kurt2rt.core.decision.standing_text import stop_text

MOST_OTHERS = 12
"""RLAs of a level that are sent in addition to the nearest: the next nearest."""


@dataclass(frozen=True, slots=True)
class LessonFact:
    """One lesson about an RLA, or its undoing."""

    text: str
    """In words, such as: RLA 17 corrected: forward instead of spin_left."""
    teacher: str
    phase: int
    tick: int
    """Of the run in which it was taught."""
    stamp: str
    """When it was written, UTC, ISO 8601; empty where that is not known."""
    undone: bool = False
    changes: bool = True
    """Whether the action is what it is by this lesson or those before it: it stands, and is no praise or blame."""


@dataclass(frozen=True, slots=True)
class RlaFacts:
    """One RLA: what it says, who taught it, when, instead of what, and how often it was used."""

    rla_id: int
    title: str
    action: str
    condition: tuple[float, ...]
    """Shape (d,)."""
    distance: float
    """To the situation that was decided on, weighted; infinite where the robot did not know where it was."""
    radius: float
    acts: tuple[LessonFact, ...]
    """Oldest first."""
    uses: int
    """How often it became the one that drives, since it was first taught."""
    uses_since: int | None
    """Likewise since it got the action that it has; None where that is not known."""
    rewards: int
    punishments: int
    value: float | None
    """What rewards made it worth; None where nobody rewarded."""
    asks: bool
    """Whether its action was withdrawn."""
    leads: bool = True
    """Whether, of those on its very condition, it is the one that answers."""


@dataclass(frozen=True, slots=True)
class LevelFacts:
    """One level of the robot in one tick."""

    level: str
    behaviour: str
    """The taught behaviour whose RLAs competed; empty where there is only one."""
    names: tuple[str, ...]
    """One per feature."""
    vector: tuple[float, ...]
    """The situation, shape (d,)."""
    weights: tuple[float, ...]
    """What each feature counts in a distance, shape (d,)."""
    euclidean: bool
    """False: of symbols, which are equal or not; a distance counts places."""
    nearest: RlaFacts | None
    """None before the first lesson."""
    driver: RlaFacts | None
    """The one whose action was followed; None while none was."""
    others: tuple[RlaFacts, ...]
    """Those behind the nearest, the nearer first: the runner-up is the first."""
    count: int
    """How many competed."""
    words: tuple[str, ...] = ()
    """The situation as people say it, where the level has words for it."""
    nearest_words: tuple[str, ...] = ()
    """The condition of the nearest, likewise."""

    @property
    def runner_up(self) -> RlaFacts | None:
        """The second nearest."""
        return self.others[0] if self.others else None

    @property
    def otherwise(self) -> RlaFacts | None:
        """The nearest that says something else than the nearest of all; None where none is known."""
        if self.nearest is None:
            return None
        return next((other for other in self.others if other.action != self.nearest.action), None)

    @property
    def lost(self) -> bool:
        """Whether the robot does not know where it is."""
        return any(math.isnan(value) for value in self.vector)

    @property
    def leader(self) -> RlaFacts | None:
        """Of those on the condition of the nearest the one that answers."""
        nearest = self.nearest
        if nearest is None or nearest.leads:
            return nearest
        same = (other for other in self.others if other.leads and other.condition == nearest.condition)
        return next(same, nearest)

    def contrast_of(self, rla: RlaFacts) -> RlaFacts | None:
        """Whom to compare it with: the nearest; of the nearest itself the next that says something else."""
        if self.nearest is not None and self.nearest.condition != rla.condition:
            return self.nearest
        return self.otherwise or self.runner_up


@dataclass(frozen=True, slots=True)
class DecisionFacts:
    """One tick's decision with all that it rested on."""

    tick: int
    now_s: float
    """On the runtime's clock."""
    robot: str
    task: str
    phase: int
    cause: str
    """A value of kurt2rt.core.decision.decision.Cause."""
    action: str | None
    """What drove; None while the robot stood."""
    asks_at: str
    """The level that asked, where one did."""
    decided: WheelSpeeds
    granted: WheelSpeeds
    reasons: tuple[str, ...]
    """Why the guard changed what was decided."""
    latched: bool
    """Whether the guard kept the robot stopped."""
    stopped: ActiveStop | None
    """The stop that held until Go; None where none did."""
    trouble: str
    """Why lessons could not be saved; empty where they could."""
    teacher: str
    """Who the teacher was; empty where nobody was."""
    infrared_counts: tuple[int, ...]
    infrared_age_s: float
    basic: LevelFacts
    mid: LevelFacts | None
    """None where the task has no mid level."""
    overridden: bool
    """Whether a teacher commanded the behaviour, and not the mid level."""
    plan_says: str
    """How it stood with the goal; empty without one."""
    kept: str = ""
    """The action whose minimum time was not over: no other one could have taken the wheels. Empty where any could."""
    history_frozen: bool = True
    """Whether the averages of the situation stood still."""
    taught_now: bool = False
    """Whether something was taught in the very tick: of what was seen then, or of what was decided."""
    hindrances: tuple[str, ...] = ()
    """Why it would have stood whatever it knew, but for a stop and its teacher's hand: values of Cause."""

    @property
    def stopped_because(self) -> str:
        """Sentence of the stop, as older devices read it; empty without one."""
        return stop_text(self.stopped)
