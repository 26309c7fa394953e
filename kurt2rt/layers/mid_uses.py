"""How often the mid level's RLAs commanded, and which followed which."""

from kurt2rt.layers.decision import Cause, Decision
from kurt2rt.rla.rla import MID
from kurt2rt.rla.statistics import StatisticsCounter


class MidUses:
    """Counts one use for each junction that an RLA led the robot to.

    A robot that stands on its way, to ask or by order, is still on that way; one that its teacher led was not led by
    an RLA.
    """

    def __init__(self, counter: StatisticsCounter) -> None:
        """`counter`: counts the other levels, too."""
        self._counter = counter
        self._anew = False

    def count(self, decision: Decision, *, driving: bool) -> None:
        """Take in one tick; `driving`: whether the wheels turned for this decision."""
        mid = decision.mid
        if mid is None:
            return
        self._anew |= mid.event is not None
        if mid.overridden or (driving and decision.cause is Cause.TEACHER):
            self.restart()
        elif driving and mid.rla_id is not None:
            self._counter.count(mid.rla_id, MID, anew=self._anew)
            self._anew = False

    def restart(self) -> None:
        """What comes next does not follow what was."""
        self._counter.count(None, MID)
        self._anew = False
