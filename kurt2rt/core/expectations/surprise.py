"""How far what came is from what was expected."""

from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True)
class SurpriseSettings:
    """When something is surprising. Chosen on seeds 0-2 of the task streets, so that few ends on known ground are."""

    least: int = 5
    """An RLA of which fewer ends were seen surprises nobody."""
    beyond: float = 2.0
    """Surprising is what is farther off than this many times the usual distance."""
    least_usual_share: float = 0.05
    """The usual distance counts as at least this share of the radius R: else what always came alike might not vary."""


class Surprise(NamedTuple):
    """What came when an RLA ended, beside what was expected."""

    level: str
    rla_id: int
    """The one that ended: whose expectation it was."""
    follow_up: int
    """The RLA that took over."""
    distance: float
    """From the expected situation to the one that came, weighted as in a match."""
    usual: float
    """The same as it usually is."""
    ends: int
    """How many ends of this RLA had been seen before."""
    seen: int
    """In how many of them this follow-up had come."""
    surprising: bool

    @property
    def multiple(self) -> float:
        """How many times the usual distance it is."""
        return self.distance / self.usual

    @property
    def new_follow_up(self) -> bool:
        """Whether this RLA had never taken over before."""
        return self.seen == 0
