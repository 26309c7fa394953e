"""How often the mid level's RLAs led the robot, and which followed which."""

from kurt2rt.core.decision.decision import Cause, Decision
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.usage_counter import StatisticsCounter


class MidUsageCounter:
    """Counts one use for each junction that an RLA led the robot through, when that has been passed.

    What was corrected before it came to that led nowhere; nor did an RLA lead where the teacher did. A robot that
    stands on its way, to ask or by order, is still on that way.
    """

    def __init__(self, counter: StatisticsCounter) -> None:
        """`counter`: counts the other levels, too."""
        self._counter = counter
        self._leads: int | None = None

    def count(self, decision: Decision, *, driving: bool) -> None:
        """Take in one tick; `driving`: whether the wheels turned for this decision."""
        mid = decision.mid
        if mid is None:
            return
        if mid.event is not None:
            self._counter.count(self._leads, MID, again=True)
        if driving:
            by_teacher = mid.overridden or decision.cause is Cause.TEACHER
            self._leads = None if by_teacher else mid.rla_id

    def restart(self) -> None:
        """What comes next does not follow what was."""
        self._counter.count(None, MID)
        self._leads = None
