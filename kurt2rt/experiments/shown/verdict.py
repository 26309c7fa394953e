"""What was asked, and what came."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Verdict:
    """One number that was asked for."""

    what: str
    asked: str
    came: str
    met: bool
    judged: bool = True
    """False: there is nothing to judge by."""

    @property
    def word(self) -> str:
        """As it is shown: a miss is in capitals, and no colour is needed to see it."""
        if not self.judged:
            return "not judged"
        return "met" if self.met else "MISSED"
