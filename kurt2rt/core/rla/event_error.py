"""Error of a teaching event that does not fit the knowledge: a code, and the numbers and names that belong to it."""

from collections.abc import Mapping
from enum import StrEnum

from kurt2rt.core.outcome import Outcome


class EventFault(StrEnum):
    """Code for why a teaching event does not fit the knowledge."""

    NOT_UNDOABLE = "not undoable"
    NOT_REDOABLE = "not redoable"
    LESSON_EXISTS = "lesson exists"
    """Another lesson has its command id."""
    RLA_EXISTS = "rla exists"
    NO_RLA = "no rla"
    BAD_CONDITION = "bad condition"
    NOT_FINITE = "not finite"
    """A named situation holds an infinite value or NaN."""
    BAD_SITUATION = "bad situation"
    """A named situation has another number of values than its level."""
    BAD_ACTION = "bad action"
    BAD_REWARD = "bad reward"
    WITHDRAWN_ALREADY = "withdrawn already"
    NO_LEVEL = "no level"
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
