"""Error of a teaching event that does not fit the knowledge: a code, and the numbers and names that belong to it."""

from collections.abc import Mapping

from config.errors import TextCode
from kurt2rt.core.outcome import Outcome


class EventFault(TextCode):
    """Code for why a teaching event does not fit the knowledge."""

    NOT_UNDOABLE = ("not undoable", "lesson {lesson!r} cannot be undone")
    NOT_REDOABLE = ("not redoable", "lesson {lesson!r} cannot be redone")
    LESSON_EXISTS = ("lesson exists", "command {command_id!r} has taught a lesson already")
    """Another lesson has its command id."""
    RLA_EXISTS = ("rla exists", "RLA {rla_id} cannot be created: ids up to {last} are taken")
    NO_RLA = ("no rla", "RLA {rla_id} does not exist (ids 1 to {last} were used; some are deleted)")
    BAD_CONDITION = ("bad condition", "RLA {rla_id}: {error}")
    NOT_FINITE = ("not finite", "the situation named {name!r} holds a value that is not finite")
    """A named situation holds an infinite value or NaN."""
    BAD_SITUATION = ("bad situation", "the situation named {name!r} has {got} values, level {level} matches {expected}")
    """A named situation has another number of values than its level."""
    BAD_ACTION = ("bad action", "the action {action!r} cannot be taught; withdraw the RLA's action instead")
    BAD_REWARD = ("bad reward", "RLA {rla_id}: wrong reward (got {value}, allowed -1, 1)")
    WITHDRAWN_ALREADY = ("withdrawn already", "{title} has no action; withdraw an action once")
    NO_LEVEL = ("no level", "{title} is of the level {level!r}, but the file does not list its features")
    """The knowledge file does not name the features of its level."""


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
