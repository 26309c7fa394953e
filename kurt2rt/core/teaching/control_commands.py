"""Control: presses and other streams, who drives, running an action, the behaviour, and the session."""

from behaviors.repertoire import Repertoire
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.rla.events import SessionBegun, SessionEnded, TeachingEvent
from kurt2rt.core.rla.rla import Origin, Phase
from kurt2rt.core.teaching.authority import ControlAuthority, StopRecord, name_refusal
from kurt2rt.core.teaching.commands import (
    BeginSession,
    EndSession,
    HandOver,
    HoldAction,
    Resume,
    RunBehaviour,
    Stop,
    Stream,
    Take,
    Watch,
)
from kurt2rt.core.teaching.driven_lessons import HoldLessons
from kurt2rt.core.teaching.knowledge_updater import require_action
from kurt2rt.core.teaching.late_press import TeacherDelay

ControlCommand = Stop | Take | HandOver | Resume | RunBehaviour


class ControlCommands:
    """Handler of streams and control commands, which change the control authority and the stops."""

    def __init__(
        self,
        repertoire: Repertoire,
        authority: ControlAuthority,
        stops: StopRecord,
        holds: HoldLessons,
        delay: TeacherDelay,
    ) -> None:
        """Connect the parts; `repertoire` holds the actions that may be run or held."""
        self._repertoire = repertoire
        self._authority = authority
        self._stops = stops
        self._holds = holds
        self._delay = delay

    def follow(self, command: Stream, tick: int) -> Outcome | None:
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

    def hold_lesson(self, tick: int, phase: Phase) -> TeachingEvent | None:
        """Return the lesson that a held action gives in this tick; None if none is due or no action is held."""
        if self._authority.held_press is None or not self._authority.is_manual(tick):
            return None
        return self._holds.build(tick, phase, self._authority.speed)

    def stop(self, stop: ActiveStop, by: str | None = None) -> None:
        """Stand until a resume.

        Args:
            stop: reason for the active stop.
            by: teacher who stopped the robot and may still drive it by hand; other teachers may not. After stops by
                two teachers neither may, because a late copy of one's stop must not lift the other's. None: no
                teacher.
        """
        self._authority.end_manual()
        self._stops.begin(stop, by)

    def carry_out(self, command: ControlCommand, tick: int) -> Outcome:
        """Carry out a command in `tick` and return the outcome. Raises CommandRefusedError if it must not be."""
        match command:
            case Stop():
                return self._stop(command, tick)
            case Take(teacher=teacher):
                before = self._authority.teacher
                refuse(self._authority.take_over(teacher, tick))
                self._stops.withdraw_teacher(before)
                return Outcome.of(ResultCode.TAKEN, teacher=teacher)
            case HandOver(teacher=teacher, to=to):
                refuse(None if to is None else name_refusal(to))
                self._authority.hand_over(to)
                self._stops.withdraw_teacher(teacher)
                return Outcome(ResultCode.RELEASED) if to is None else Outcome.of(ResultCode.HANDED_OVER, teacher=to)
            case Resume():
                self._stops.resume()
                self._authority.end_manual()
                return Outcome(ResultCode.RESUMED)
            case RunBehaviour():
                return self._run(command, tick)

    def _stop(self, command: Stop, tick: int) -> Outcome:
        teacher, press_id = command.teacher, command.press_id
        if press_id is not None and self._authority.drives_by_later_press(teacher, press_id, tick):
            return Outcome(ResultCode.RELEASE_SUPERSEDED)
        if press_id is not None and self._authority.is_hold(teacher, press_id):
            return self._release(press_id)
        self._stops.count(command.command_id, tick)
        self.stop(ActiveStop(StopReason.SAID_STOP if press_id is None else StopReason.LET_GO, teacher), teacher)
        return Outcome(ResultCode.STOPPED)

    def _run(self, command: RunBehaviour, tick: int) -> Outcome:
        require_action(command.action, self._repertoire)
        refuse(self._stops.refusal_since(command.seen_tick) or self._stops.refusal_by_another(command.teacher))
        if not self._authority.is_present(tick):
            raise CommandRefusedError(RefusalCode.TEACHER_ABSENT)
        self.stop(ActiveStop(StopReason.BEHAVIOUR_OVER, command.action), command.teacher)
        self._authority.run(command.action, tick, command.ticks)
        return Outcome.of(ResultCode.ACTION_RUNS, action=command.action, ticks=command.ticks)

    def _release(self, press_id: int) -> Outcome:
        """End the hold of a press, so that the RLAs drive on; a late release changes nothing."""
        if self._authority.held_press == press_id:
            self._authority.end_manual()
        hold = self._holds.newest
        if hold is None or hold.press_id != press_id or hold.lessons == 0:
            return Outcome.of(ResultCode.HOLD_RELEASED, lessons=0, lesson=None)
        return Outcome.of(ResultCode.HOLD_RELEASED, lessons=hold.lessons, lesson=hold.lesson)

    def _hold(self, command: HoldAction, tick: int) -> None:
        if self._authority.held_press == command.press_id:
            self._holds.on_message(command, tick)
        else:
            self._holds.begin(command, tick, self._authority.speed)
            self._delay.on_answer(command.teacher, command.seen_tick, self._authority.speed)
        self._authority.hold(command, tick)


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
