"""Record of stops: the active stop, the teachers who gave it, and the copies of their commands."""

from collections import deque

from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode

_KNOWN_STOPS = 32
"""Number of stops whose copies are recognised; a copy of an older one counts as another stop, which is safe."""


class StopRecord:
    """Active stop with the teachers who gave it, and the rules that decide which command may lift it."""

    def __init__(self) -> None:
        self.active: ActiveStop | None = None
        """Stop that lasts until a resume; None without one."""
        self.newest_tick = -1
        """Tick of the last stop by a teacher or the guard; a command given on an older state must not lift it."""
        self._teachers: set[str] = set()
        self._command_ids: deque[str] = deque(maxlen=_KNOWN_STOPS)
        """Ids of the stop commands since the last resume."""

    def begin(self, stop: ActiveStop, by: str | None) -> None:
        """Replace the active stop; `by`: teacher who gave it, in addition to those before; None: no teacher."""
        self.active = stop
        if by is not None:
            self._teachers.add(by)

    def begin_manual(self, teacher: str) -> None:
        """Let the robot stand after a manual drive until a resume, also when its messages cease."""
        self.active = ActiveStop(StopReason.LET_GO, teacher)
        self._teachers = {teacher}

    def resume(self) -> None:
        """End the active stop and forget its teachers."""
        self.active = None
        self._teachers.clear()
        self._command_ids.clear()

    def count(self, command_id: str, tick: int) -> None:
        """Count a stop command; a copy is not a newer stop, because a teacher who resumes has seen the original."""
        if command_id not in self._command_ids:
            self._command_ids.append(command_id)
            self.newest_tick = tick

    def withdraw_teacher(self, teacher: str | None) -> None:
        """Let the next teacher drive by hand although the one before stopped the robot, which stays stopped."""
        if teacher is not None:
            self._teachers.discard(teacher)

    def refusal_since(self, seen_tick: int | None) -> Outcome | None:
        """Return the refusal of a command given on the state of `seen_tick` if a stop came since; None otherwise."""
        if seen_tick is None or seen_tick >= self.newest_tick:
            return None
        return Outcome(RefusalCode.STOPPED_SINCE)

    def refusal_by_another(self, teacher: str) -> Outcome | None:
        """Return the refusal of a manual drive if another teacher stopped the robot; None otherwise."""
        others = tuple(sorted(self._teachers - {teacher}))
        return Outcome.of(RefusalCode.STOPPED_BY, teachers=others) if others else None
