"""Fault with a time span."""

from typing import Literal, NamedTuple

Kind = Literal["off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent"]
"""Kinds of fault: no output, repeated output, random output, plausible but false output, output at a lower rate, late
output, and output with interruptions.
"""


class TimedFault(NamedTuple):
    """One fault for one span of simulated time."""

    kind: Kind
    begin_s: float
    end_s: float
    period_s: float
    """slow: time between two outputs. intermittent: length of each span of failing and of working."""
    delay_s: float
    """delayed: the delay."""

    def acts(self, now_s: float) -> bool:
        """Return whether the fault acts at `now_s`, in s; an intermittent one acts while it fails."""
        if not self.begin_s <= now_s < self.end_s:
            return False
        return self.kind != "intermittent" or int((now_s - self.begin_s) / self.period_s) % 2 == 0
