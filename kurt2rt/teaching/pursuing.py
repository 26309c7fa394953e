"""The teacher says which taught behaviour is to be followed: for good, or before a mid level until a junction."""

from kurt2rt.layers.wanted import Wanted
from kurt2rt.teaching.commands import Pursue
from kurt2rt.teaching.mid_lessons import MidLessons
from kurt2rt.teaching.refused import RefusedError


class Pursuing:
    """Takes the wishes of teachers in the order in which they saw the robot, however late they come."""

    def __init__(self, wanted: Wanted, mid: MidLessons | None) -> None:
        """`mid`: None: nobody but the teacher says what is wanted."""
        self._wanted = wanted
        self._mid = mid
        self._seen_tick = -1
        """What the teacher had seen when he said what is wanted now."""

    def take(self, command: Pursue, tick: int) -> str:
        """Want what he says, in this tick; what was done, in words. Raises RefusedError."""
        wanted, mid = self._wanted, self._mid
        seen_tick = tick if command.seen_tick is None else command.seen_tick
        if seen_tick < self._seen_tick:
            raise RefusedError(
                f"{wanted.behaviour or 'the only behaviour'} was asked for after this was said; "
                "look at the robot, then say it again"
            )
        if mid is not None and seen_tick < mid.passed_at_tick:
            raise RefusedError("a junction was passed after this was said; look at the robot, then say it again")
        try:
            if mid is None:
                wanted.pursue(command.behaviour)
            else:
                mid.mid.override(command.behaviour)
        except ValueError as error:
            raise RefusedError(str(error)) from error
        self._seen_tick = seen_tick
        so_long = "" if mid is None else " until the next junction is passed"
        return f"{command.behaviour or 'the only behaviour'} is wanted{so_long}"
