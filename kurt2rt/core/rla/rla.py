"""One rule-like association, and the teaching acts that make, change and end it."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

from kurt2rt.core.rla.condition import Condition, packed
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.credit import packed as packed_credits

ASK = "ask"
"""Instead of an action: the RLA's was withdrawn, so where it is nearest the robot asks. No repertoire has this name."""

BASIC = "basic"
"""The level whose RLAs drive the wheels."""

MID = "mid"
"""The level whose RLAs say which taught behaviour of the basic level is wanted."""

CRITIC = "critic"
"""The level whose RLAs say what a situation is worth, in place of a teacher; also the critic's name as a teacher."""


class Phase(IntEnum):
    """The paper's five training phases (section IV)."""

    SUPERVISED = 1
    CORRECTIONS = 2
    REINFORCEMENT = 3
    CRITIC = 4
    AUTONOMOUS = 5


@dataclass(frozen=True, slots=True)
class Origin:
    """Who taught something, and when on the robot's own clock."""

    command_id: str
    """Name of the teacher's command; a command that comes twice counts once."""
    teacher: str
    phase: Phase
    tick: int
    """Tick of the run in which the command acted."""


def rla_title(rla_id: int, behaviour: str, level: str = BASIC) -> str:
    """How an RLA is spoken of: RLA 17, RLA 17 of turn_left where the behaviour has a name, mid-level RLA 12."""
    kind = {BASIC: "RLA", MID: "mid-level RLA", CRITIC: "appraisal RLA"}.get(level, f"{level} RLA")
    return f"{kind} {rla_id} of {behaviour}" if behaviour else f"{kind} {rla_id}"


@dataclass(frozen=True, slots=True)
class Rla:
    """A rule-like association (paper, III.A). The expectation is left blank until the robot has used it."""

    rla_id: int
    """1, 2, 3 ... in the order of teaching; of two equally near RLAs the older, smaller one wins."""
    condition: Condition
    action: str
    """A name in the repertoire of its level, or ASK."""
    radius: float | None
    """Own confidence radius; None: that of the system."""
    origin: Origin
    """Who taught the action it has now, and when."""
    behaviour: str = ""
    """The taught behaviour it belongs to: it answers only while that one is wanted. Empty where a task has only one."""
    level: str = BASIC
    """Whose situations it answers: the features of its condition are that level's."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "condition", packed(self.condition))

    @property
    def title(self) -> str:
        """How it is spoken of."""
        return rla_title(self.rla_id, self.behaviour, self.level)

    @property
    def is_withdrawn(self) -> bool:
        """Whether its action was withdrawn: it knows the situation as one in which the teacher is asked."""
        return self.action == ASK


@dataclass(frozen=True, slots=True)
class RlaCreated:
    """The teacher answered a situation: a new RLA stands there (phase 1, or inserted in phase 2)."""

    rla: Rla

    @property
    def origin(self) -> Origin:
        """Who taught it, and when."""
        return self.rla.origin


@dataclass(frozen=True, slots=True)
class ActionReplaced:
    """The teacher corrected an RLA: it has another action from now on (phase 2)."""

    rla_id: int
    action: str
    instead_of: str
    """May be ASK: the teacher answered where an action had been withdrawn."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class ActionWithdrawn:
    """An RLA's value has sunk, so it loses its action: where it is nearest the robot asks from now on (phase 3)."""

    rla_id: int
    instead_of: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class RlaDeleted:
    """The teacher deleted an RLA while the robot was running (phase 2)."""

    rla_id: int
    origin: Origin


@dataclass(frozen=True, slots=True)
class RlaRewarded:
    """The teacher, or the critic in his place, praised or blamed what an RLA decided (phase 3)."""

    rla_id: int
    """The one that drove in the tick that was meant."""
    value: int
    """+1 reward, -1 punishment."""
    decided_at_tick: int
    """Tick of the decision that was meant."""
    origin: Origin
    credits: Sequence[Credit] = ()
    """What the values of RLAs were changed by, its own and those that had driven before it; undo takes it off."""
    said: int | None = None
    """What the critic thought of that tick before it was told: -1, 0 or +1; None: nothing."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "credits", packed_credits(self.credits))


@dataclass(frozen=True, slots=True)
class Appraised:
    """The teacher said what a situation is worth, and the critic thought so too: changes no RLA (phase 4)."""

    appraisal: str
    """Its name in the critic's repertoire."""
    value: int
    """-1, 0 or +1."""
    decided_at_tick: int
    """Tick of the situation that was meant."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class SituationNamed:
    """The teacher gave a situation a name, so that the robot can be sent there: changes no RLA."""

    name: str
    """One that was given already means this situation from now on."""
    situation: Condition
    """A point in the feature space of its level."""
    level: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class LessonUndone:
    """The teacher took one lesson back: what it made, changed, ended or rewarded is as before it."""

    lesson: str
    """Command id of the lesson."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class LessonRedone:
    """A lesson that had been taken back stands again, as it was taught."""

    lesson: str
    """Command id of the lesson."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class KnowledgeMerged:
    """Lessons of another knowledge file were brought in, in the rows before this one; changes no RLA by itself."""

    source: str
    """Name of the other file."""
    rows: int
    """How many rows it had then; what it holds up to there is here, or was left out on purpose."""
    last: str
    """Command id of the last of those rows: tells whether a file is that one, or goes on from it."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class SessionBegun:
    """A teacher began to teach; changes no RLA."""

    name: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class SessionEnded:
    """A teacher stopped teaching; changes no RLA."""

    lasted_ticks: int
    """Teaching time, waits included."""
    origin: Origin


RlaLesson = RlaCreated | ActionReplaced | ActionWithdrawn | RlaDeleted | RlaRewarded
"""A lesson about one RLA."""

Lesson = RlaLesson | SituationNamed
"""A teaching act that can be undone."""

TeachingEvent = Lesson | LessonUndone | LessonRedone | Appraised | SessionBegun | SessionEnded | KnowledgeMerged
"""What the knowledge journal holds; the RLA system is the fold of these."""
