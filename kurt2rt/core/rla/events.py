"""Teaching events: they create, change, reward and delete RLAs, and the knowledge journal holds them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from config.errors import TextCode
from kurt2rt.core.outcome import Outcome
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.credit import Credit, pack_credits
from kurt2rt.core.rla.rla import Origin, Rla


@dataclass(frozen=True, slots=True)
class RlaCreated:
    """Answer of a teacher to a situation: a new RLA (phase 1, or inserted in phase 2)."""

    rla: Rla

    @property
    def origin(self) -> Origin:
        """Origin of the new RLA, which is the event's origin."""
        return self.rla.origin


@dataclass(frozen=True, slots=True)
class ActionReplaced:
    """Teaching event of a correction: an RLA gets another action (phase 2)."""

    rla_id: int
    action: str
    instead_of: str
    """Previous action; ASK if it had been withdrawn."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class ActionWithdrawn:
    """Withdrawal of the action of an RLA whose value is too low: the robot asks there (phase 3)."""

    rla_id: int
    instead_of: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class RlaDeleted:
    """Teaching event that deletes an RLA, by a teacher or by the robot's own repair."""

    rla_id: int
    origin: Origin


@dataclass(frozen=True, slots=True)
class RlaRewarded:
    """Reward or punishment of an RLA's decision, by a teacher or the critic (phase 3)."""

    rla_id: int
    """RLA that drove in the rewarded tick."""
    value: int
    """+1 reward, -1 punishment."""
    decided_at_tick: int
    """Tick of the rewarded decision."""
    origin: Origin
    credits: Sequence[Credit] = ()
    """Changes of the values of this RLA and its predecessors; an undo subtracts them."""
    said: int | None = None
    """Critic's opinion of that tick before the reward: -1, 0 or +1; None without an opinion."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "credits", pack_credits(self.credits))


@dataclass(frozen=True, slots=True)
class Appraised:
    """Appraisal of a situation that agrees with the critic's opinion: changes no RLA (phase 4)."""

    appraisal: str
    """Name in the critic's repertoire."""
    value: int
    """-1, 0 or +1."""
    decided_at_tick: int
    """Tick of the appraised situation."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class SituationNamed:
    """Name for a situation, so that it can be a goal: changes no RLA."""

    name: str
    """A name that exists already is moved to this situation."""
    situation: Condition
    """Point in the feature space of its level."""
    level: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class LessonUndone:
    """Undo of one lesson: its RLA, name or reward is as before the lesson."""

    lesson: str
    """Command id of the lesson."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class LessonRedone:
    """Teaching event that lets a lesson stand again which an undo had taken back."""

    lesson: str
    """Command id of the lesson."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class SessionBegun:
    """Teaching event at the beginning of a named session, whose time counts as teaching; changes no RLA."""

    name: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class SessionEnded:
    """Teaching event at the end of a session, which adds to the time of teaching; changes no RLA."""

    lasted_ticks: int
    """Duration in ticks, waits included."""
    origin: Origin


RlaLesson = RlaCreated | ActionReplaced | ActionWithdrawn | RlaDeleted | RlaRewarded
"""Lesson about one RLA."""

Lesson = RlaLesson | SituationNamed
"""One change of knowledge that can be undone, such as a new RLA or a reward; never a whole session.

Its id is the id of the command that gave it, so a repeated command counts once."""

TeachingEvent = Lesson | LessonUndone | LessonRedone | Appraised | SessionBegun | SessionEnded
"""Entry of the knowledge journal: all that teaching can change. The RLA system is the fold of these events.

The tick makes and applies one, then submits it to `EventStore`. A command is acknowledged once its event is on disk."""


class EventFault(TextCode):
    """Code for why a teaching event does not fit the knowledge."""

    NOT_UNDOABLE = ("not undoable", "lesson {lesson!r} cannot be undone")
    NOT_REDOABLE = ("not redoable", "lesson {lesson!r} cannot be redone")
    LESSON_EXISTS = ("lesson exists", "command {command_id!r} has taught a lesson already")
    RLA_EXISTS = ("rla exists", "RLA {rla_id} cannot be created: ids up to {last} are taken")
    NO_RLA = ("no rla", "RLA {rla_id} does not exist (ids 1 to {last} were used; some are deleted)")
    BAD_CONDITION = ("bad condition", "RLA {rla_id}: {error}")
    NOT_FINITE = ("not finite", "the situation named {name!r} holds a value that is not finite")
    BAD_SITUATION = ("bad situation", "the situation named {name!r} has {got} values, level {level} matches {expected}")
    BAD_ACTION = ("bad action", "the action {action!r} cannot be taught; withdraw the RLA's action instead")
    BAD_REWARD = ("bad reward", "RLA {rla_id}: wrong reward (got {value}, allowed -1, 1)")
    WITHDRAWN_ALREADY = ("withdrawn already", "{title} has no action; withdraw an action once")
    NO_LEVEL = ("no level", "{title} is of the level {level!r}, but the file does not list its features")


class InvalidEventError(ValueError):
    """Teaching event that does not fit the knowledge it should change; `kurt2rt.core.outcome_text` words it."""

    def __init__(
        self, fault: EventFault, fields: Mapping[str, int | str] | None = None, refusal: Outcome | None = None
    ) -> None:
        """`refusal`: why a lesson cannot be undone or redone; None for other faults."""
        super().__init__(fault, fields, refusal)
        self.fault = fault
        self.fields = dict(fields or {})
        self.refusal = refusal

    @classmethod
    def of(cls, fault: EventFault, **fields: int | str) -> "InvalidEventError":
        """Return the error of a fault; `fields` fill the gaps in the fault's text."""
        return cls(fault, fields)

    def __str__(self) -> str:
        details = self.fields if self.refusal is None else {"refusal": self.refusal.code, **self.refusal.fields}
        return ", ".join((self.fault, *(f"{key} {value}" for key, value in details.items())))
