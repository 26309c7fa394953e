"""Who teaches, whether that one is there, and what his hand does at the wheels."""

from behaviors.behaviour import Behaviour
from behaviors.repertoire import Repertoire
from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.teaching.commands import Drive

_BY_HAND = "by hand"


class ControlAuthority:
    """One teacher at a time. His hand has a lease that the loop ends, so a silent teacher is a robot that stands.

    Whoever speaks first is the teacher; another one becomes it only by `take` or when it is handed over.
    """

    def __init__(
        self, repertoire: Repertoire, *, attended: bool, lease_ticks: int = 24, max_picture_age_ticks: int = 35
    ) -> None:
        """`attended`: the robot needs a teacher who is there. A message is good for `lease_ticks` from its arrival, and
        never for longer than `reach_ticks` from the picture it was given on, however long it was on its way.
        """
        self.attended = attended
        self.teacher: str | None = None
        self.speed = 1
        """Robot seconds in one second, as chosen. A lease is a teacher's, so it is that much longer in robot time."""
        self._repertoire = repertoire
        self._lease_ticks = lease_ticks
        self._max_picture_age_ticks = max_picture_age_ticks
        self._present_until = -1
        self._press_ids: dict[str, int] = {}
        self._ended_press_ids: dict[str, int] = {}
        self._speeds: WheelSpeeds | None = None
        self._driven_until = -1
        self._behaviour: Behaviour | None = None
        self._behaviour_name = ""
        self._behaviour_until = -1

    def refusal_for(self, teacher: str) -> Outcome | None:
        """Return why this teacher may not teach now; None if they may."""
        if self.teacher is None or self.teacher == teacher:
            return None
        return Outcome.of(RefusalCode.ANOTHER_TEACHES, teacher=self.teacher)

    def claim(self, teacher: str) -> None:
        """Become the teacher where nobody is; call it for every command that is carried out."""
        if self.teacher is None:
            self._set_teacher(teacher)

    def take_over(self, teacher: str, tick: int) -> Outcome | None:
        """Become the teacher also in place of another one; return a refusal while that one drives by hand."""
        if self.teacher not in (None, teacher) and self.is_manual(tick):
            return Outcome.of(RefusalCode.DRIVES_BY_HAND, teacher=self.teacher)
        if self.teacher != teacher:
            self._set_teacher(teacher)
        return None

    def hand_over(self, to: str | None) -> None:
        """Nobody, or another one, is the teacher; that one has to be there before the robot drives on."""
        self._set_teacher(to)

    def renew_presence(self, teacher: str, tick: int, seen_tick: int) -> None:
        """A sign that the teacher is there, arrived now and given on the picture of `seen_tick`."""
        if teacher == self.teacher:
            self._present_until = max(self._present_until, self._lease_end(tick, seen_tick))

    def extend_leases(self, ticks: int) -> None:
        """Extend every lease by ticks that were missed, in which nothing could move and no message be read."""
        self._present_until += ticks
        self._driven_until += ticks
        self._behaviour_until += ticks

    def is_present(self, tick: int) -> bool:
        """Whether the teacher is there; always where none is needed."""
        return not self.attended or tick < self._present_until

    def drives_by_later_press(self, teacher: str, press_id: int, tick: int) -> bool:
        """Whether this teacher drives by a later press than `hold`."""
        return self.is_manual(tick) and self.teacher == teacher and self._press_ids.get(teacher, -1) > press_id

    def reset_sequence(self, teacher: str) -> None:
        """His device has new keys, and counts its presses anew."""
        self._press_ids.pop(teacher, None)
        self._ended_press_ids.pop(teacher, None)

    def is_press_over(self, command: Drive) -> bool:
        """Whether a stop, silence, or a later press has ended this one: what comes of it now was held up on its way."""
        ended, newest = self._ended_press_ids.get(command.teacher, -1), self._press_ids.get(command.teacher, -1)
        return command.hold <= ended or command.hold < newest

    @property
    def absence_stop(self) -> ActiveStop:
        """Stop of a robot that drove and whose teacher is not present."""
        if self.teacher is None:
            return ActiveStop(StopReason.NO_TEACHER)
        reason = StopReason.LINK_LOST if self._present_until >= 0 else StopReason.TEACHER_NOT_YET
        return ActiveStop(reason, self.teacher)

    def drive(self, command: Drive, tick: int) -> None:
        """Take or keep the wheels; for the teacher, with a press that is not over."""
        self._press_ids[command.teacher] = command.hold
        self._behaviour = None
        self._speeds = WheelSpeeds(command.left_m_s, command.right_m_s)
        self._driven_until = self._lease_end(tick, command.seen_tick)
        self.renew_presence(command.teacher, tick, command.seen_tick)

    def run(self, action: str, tick: int, ticks: int) -> None:
        """Let an action of the repertoire drive for so many ticks, while the teacher is there."""
        self._speeds = None
        self._behaviour = self._repertoire[action]
        self._behaviour.start()
        self._behaviour_name = action
        self._behaviour_until = tick + ticks

    def end_manual(self) -> None:
        """Take the wheels from the teacher's hand: every press so far is over, whatever of it is still on its way."""
        self._ended_press_ids.update(self._press_ids)
        self._speeds = None
        self._behaviour = None

    def is_manual(self, tick: int) -> bool:
        """Return whether the teacher drives by hand or runs a behaviour in this tick."""
        if self._speeds is not None:
            return tick < self._driven_until
        return self._behaviour is not None and tick < self._behaviour_until and self.is_present(tick)

    def expire(self, tick: int) -> None:
        """End a press or a run whose lease is over in this tick; the tick calls it before it decides."""
        if not self.is_manual(tick) and (self._speeds is not None or self._behaviour is not None):
            self.end_manual()

    def step(self, senses: SensorReadings) -> tuple[str, WheelSpeeds]:
        """Return a name for the action of the manual drive and its wheel speeds; only while `is_manual`."""
        if self._speeds is not None:
            return _BY_HAND, self._speeds
        assert self._behaviour is not None
        return self._behaviour_name, self._behaviour.step(senses)

    def _set_teacher(self, teacher: str | None) -> None:
        self.end_manual()
        self.teacher = teacher
        self._present_until = -1

    def _lease_end(self, tick: int, seen_tick: int) -> int:
        return min(tick + self._lease_ticks * self.speed, seen_tick + self._max_picture_age_ticks * self.speed)
