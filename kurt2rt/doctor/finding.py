"""What one check found."""

from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """How well the machine serves in one respect."""

    OK = "ok"
    WARNING = "warning"
    MISSING = "missing"


@dataclass(frozen=True, slots=True)
class Finding:
    """One respect in which the machine was looked at."""

    subject: str
    status: Status
    found: str
    what_to_do: str = ""
    """One line, mostly a command to copy; empty when there is nothing to do."""
    needed: bool = False
    """True for what `kurt2rt run` cannot do without."""

    @property
    def forbids_run(self) -> bool:
        """True when `kurt2rt run` cannot start because of this."""
        return self.needed and self.status is Status.MISSING
