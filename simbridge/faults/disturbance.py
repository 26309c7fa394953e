"""What is wrong, from when to when."""

from typing import Literal, NamedTuple

Kind = Literal["off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent"]
"""The seven ways in which something fails: gives nothing, repeats itself, gives nonsense, gives what is plausible and
false, comes less often, comes late, comes and goes."""


class TimedFault(NamedTuple):
    """One fault, for one span of simulated time."""

    kind: Kind
    begin_s: float
    end_s: float
    period_s: float
    """slow: between two that pass. intermittent: each span of failing, and each of working."""
    delay_s: float
    """delayed: how late."""

    def acts(self, now_s: float) -> bool:
        """Whether it is there at this time; one that comes and goes counts as there when it fails."""
        if not self.begin_s <= now_s < self.end_s:
            return False
        return self.kind != "intermittent" or int((now_s - self.begin_s) / self.period_s) % 2 == 0
