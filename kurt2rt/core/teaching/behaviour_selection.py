"""Behaviour selection by the teacher: permanently, or under a mid level until the next junction."""

from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.teaching.commands import Pursue
from kurt2rt.core.teaching.mid_lessons import MidLessons


class BehaviourSelection:
    """Selection in the order in which teachers saw the robot; a late command on an older state is refused."""

    def __init__(self, active_behaviour: ActiveBehaviour, mid: MidLessons | None) -> None:
        """`mid`: lessons of the mid level; None: the teacher alone selects."""
        self._active_behaviour = active_behaviour
        self._mid = mid
        self._seen_tick = -1
        """Tick that the teacher had seen at the last selection."""

    def select(self, command: Pursue, tick: int) -> Outcome:
        """Select the behaviour of a command from `tick` on and return the outcome.

        Raises CommandRefusedError for an unknown behaviour, and if the teacher saw a state older than the last
        selection or the last junction.
        """
        wanted, mid = self._active_behaviour, self._mid
        seen_tick = tick if command.seen_tick is None else command.seen_tick
        if seen_tick < self._seen_tick:
            raise CommandRefusedError(RefusalCode.BEHAVIOUR_SINCE, behaviour=wanted.behaviour)
        if mid is not None and seen_tick < mid.passed_at_tick:
            raise CommandRefusedError(RefusalCode.JUNCTION_PASSED)
        if mid is None:
            wanted.select(command.behaviour)
        else:
            mid.mid.override(command.behaviour)
        self._seen_tick = seen_tick
        code = ResultCode.BEHAVIOUR_WANTED if mid is None else ResultCode.BEHAVIOUR_WANTED_TO_JUNCTION
        return Outcome.of(code, behaviour=command.behaviour)
