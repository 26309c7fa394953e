"""Commands about who drives: stopping, resuming, taking the robot, handing it over, and running an action."""

from behaviors.repertoire import Repertoire
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.teaching.authority import ControlAuthority, name_refusal
from kurt2rt.core.teaching.commands import HandOver, Resume, RunBehaviour, Stop, Take
from kurt2rt.core.teaching.known_names import require_action
from kurt2rt.core.teaching.stop_record import StopRecord
from kurt2rt.core.teaching.stream_handler import StreamHandler

ControlCommand = Stop | Take | HandOver | Resume | RunBehaviour


class ControlCommands:
    """Handler of control commands, which change the control authority and the stops."""

    def __init__(
        self, repertoire: Repertoire, authority: ControlAuthority, stops: StopRecord, streams: StreamHandler
    ) -> None:
        """Connect the parts; `repertoire` holds the actions that may be run."""
        self._repertoire = repertoire
        self._authority = authority
        self._stops = stops
        self._streams = streams

    def stop(self, stop: ActiveStop, by: str | None) -> None:
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
            return self._streams.release(press_id)
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
