"""Sessions, and how long they last: the time that the paper counts as teaching."""

from kurt2rt.rla.rla import Origin, SessionBegun, SessionEnded, TeachingEvent
from kurt2rt.teaching.commands import BeginSession, EndSession
from kurt2rt.teaching.refused import RefusedError


class TeachingClock:
    """Runs while a session is on; one at a time."""

    def __init__(self) -> None:
        self.session: str | None = None
        """Name of the session that is on."""
        self._from_tick = 0
        self._lasted_ticks = 0

    def ticks(self, tick: int) -> int:
        """How long the session that is on has lasted at `tick`, or how long the last one did."""
        return self._lasted_ticks if self.session is None else tick - self._from_tick

    def take(self, command: BeginSession | EndSession, tick: int, origin: Origin) -> tuple[str, TeachingEvent]:
        """Begin or end a session: what was done, and the event that tells it. Raises RefusedError."""
        if isinstance(command, BeginSession):
            if self.session is not None:
                raise RefusedError(f"the session {self.session!r} is on; end it first")
            self.session, self._from_tick = command.name, tick
            return f"session {command.name!r} begins", SessionBegun(command.name, origin)
        if self.session is None:
            raise RefusedError("no session is on")
        name, self._lasted_ticks = self.session, self.ticks(tick)
        self.session = None
        return f"session {name!r} is over; the robot stands", SessionEnded(self._lasted_ticks, origin)
