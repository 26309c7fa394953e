"""Stream handler: applies signs of presence, manual drive and held actions."""

from behaviors.repertoire import Repertoire
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.authority import ControlAuthority, name_refusal
from kurt2rt.core.teaching.commands import HoldAction, Stream, Watch
from kurt2rt.core.teaching.hold_lessons import HoldLessons
from kurt2rt.core.teaching.late_press import TeacherDelay
from kurt2rt.core.teaching.stop_record import StopRecord


class StreamHandler:
    """Handler of the messages in which only the newest counts."""

    def __init__(
        self,
        repertoire: Repertoire,
        authority: ControlAuthority,
        stops: StopRecord,
        holds: HoldLessons,
        delay: TeacherDelay,
    ) -> None:
        """Connect the parts; `repertoire` holds the actions that may be held."""
        self._repertoire = repertoire
        self._authority = authority
        self._stops = stops
        self._holds = holds
        self._delay = delay

    def handle(self, command: Stream, tick: int) -> Outcome | None:
        """Apply a message of a stream in this tick; return a refusal, or None if it was applied."""
        authority = self._authority
        refusal = name_refusal(command.teacher) or authority.refusal_for(command.teacher) or self.press_refusal(command)
        if refusal is not None:
            return refusal
        if isinstance(command, Watch):
            authority.renew_presence(command.teacher, tick, command.seen_tick)
            return None
        authority.claim(command.teacher)
        if isinstance(command, HoldAction):
            self._hold(command, tick)
        else:
            authority.drive(command, tick)
            self._stops.begin_manual(command.teacher)
        return None

    def press_refusal(self, command: Stream) -> Outcome | None:
        """Return why this press does not drive the robot; None if it does, and for a sign of presence."""
        if isinstance(command, Watch):
            return None
        if self._authority.is_press_over(command):
            return Outcome(RefusalCode.PRESS_OVER)
        if isinstance(command, HoldAction):
            if command.action not in self._repertoire:
                return Outcome.of(RefusalCode.NO_ACTION, action=command.action, known=tuple(self._repertoire))
            return None if self._stops.active is None else Outcome(RefusalCode.ROBOT_STOPPED)
        return self._stops.refusal_by_another(command.teacher)

    def release(self, press_id: int) -> Outcome:
        """End the hold of a press, so that the RLAs drive on; return how many lessons it gave.

        A late release of an ended hold changes nothing.
        """
        if self._authority.held_press == press_id:
            self._authority.end_manual()
        hold = self._holds.newest
        if hold is None or hold.press_id != press_id or hold.lessons == 0:
            return Outcome.of(ResultCode.HOLD_RELEASED, lessons=0, lesson=None)
        return Outcome.of(ResultCode.HOLD_RELEASED, lessons=hold.lessons, lesson=hold.lesson)

    def hold_lesson(self, tick: int, phase: Phase) -> TeachingEvent | None:
        """Return the lesson that a held action gives in this tick; None if none is due or no action is held."""
        if self._authority.held_press is None or not self._authority.is_manual(tick):
            return None
        return self._holds.build(tick, phase, self._authority.speed)

    def _hold(self, command: HoldAction, tick: int) -> None:
        if self._authority.held_press == command.press_id:
            self._holds.on_message(command, tick)
        else:
            self._holds.begin(command, tick, self._authority.speed)
            self._delay.on_answer(command.teacher, command.seen_tick, self._authority.speed)
        self._authority.hold(command, tick)
