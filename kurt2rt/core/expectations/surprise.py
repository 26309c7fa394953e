"""Surprise: distance between the expected situation and the real one."""

from typing import NamedTuple

# Chosen on seeds 0 to 2 of the task streets, so that known ground rarely surprises.
LEAST_ENDS = 5
"""Least number of earlier ends of an RLA."""
BEYOND = 2.0
"""Multiple of the usual distance beyond which an end is surprising."""
LEAST_USUAL_SHARE = 0.05
"""Least usual distance as a share of the radius R, for RLAs whose ends hardly vary."""


class Surprise(NamedTuple):
    """Comparison of an RLA's real end with its expectation, after at least LEAST_ENDS ends.

    `distance` is ||w (situation - mean)||, `usual` the root of the summed weighted variances. It is surprising beyond
    BEYOND times the usual distance. Page and recording show it; it changes no decision.
    """

    level: str
    rla_id: int
    """RLA that ended."""
    follow_up: int
    """RLA that took over."""
    distance: float
    """Distance from the expected to the real situation, weighted as in a match."""
    usual: float
    """Usual distance."""
    ends: int
    """Number of earlier ends of this RLA."""
    seen: int
    """Number of earlier ends with this follow-up."""
    surprising: bool

    @property
    def multiple(self) -> float:
        """Distance as a multiple of the usual one."""
        return self.distance / self.usual

    @property
    def new_follow_up(self) -> bool:
        """Return whether this follow-up is new for the RLA."""
        return self.seen == 0
