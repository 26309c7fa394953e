"""Sessions and their length, which the paper counts as teaching time."""

from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import SessionBegun, SessionEnded, TeachingEvent
from kurt2rt.core.rla.rla import Origin
from kurt2rt.core.teaching.commands import BeginSession, EndSession


class SessionClock:
    """Clock of the session; at most one session is open."""

    def __init__(self) -> None:
        self.session: str | None = None
        """Name of the open session; None without one."""
        self._from_tick = 0
        self._lasted_ticks = 0

    def ticks(self, tick: int) -> int:
        """Return the length of the open session at `tick`, or of the last one, in ticks."""
        return self._lasted_ticks if self.session is None else tick - self._from_tick

    def apply(self, command: BeginSession | EndSession, tick: int, origin: Origin) -> tuple[Outcome, TeachingEvent]:
        """Begin or end a session; return the outcome and the event.

        Raises CommandRefusedError if a session is open at its beginning, or none is at its end.
        """
        if isinstance(command, BeginSession):
            if self.session is not None:
                raise CommandRefusedError(RefusalCode.SESSION_ON, session=self.session)
            self.session, self._from_tick = command.name, tick
            return Outcome.of(ResultCode.SESSION_BEGUN, session=command.name), SessionBegun(command.name, origin)
        if self.session is None:
            raise CommandRefusedError(RefusalCode.NO_SESSION)
        name, self._lasted_ticks = self.session, self.ticks(tick)
        self.session = None
        return Outcome.of(ResultCode.SESSION_ENDED, session=name), SessionEnded(self._lasted_ticks, origin)
