"""Control authority: which teacher may command and drive, and the stops that teachers gave."""

from collections import deque

from behaviors.behaviour import Behaviour
from behaviors.repertoire import Repertoire
from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.rla import CRITIC
from kurt2rt.core.teaching.commands import Drive, HoldAction

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


_LEASE_TICKS = 24
"""Validity of a message from its arrival."""
_PICTURE_TICKS = 35
"""Validity of a message from the state that its teacher saw when giving it."""
_BY_HAND = "by hand"


class ControlAuthority:
    """Control authority of one teacher at a time, with leases for presence and manual drive.

    The tick ends a lease, so a robot whose teacher is silent stands. The first teacher who commands gets authority;
    another one gets it only by `take_over` or `hand_over`.
    """

    def __init__(self, repertoire: Repertoire, *, attended: bool) -> None:
        """Start without a teacher.

        Args:
            repertoire: actions that the teacher can run; used by nothing else.
            attended: whether the robot drives by its RLAs only while a teacher is present.
        """
        self.attended = attended
        self.teacher: str | None = None
        self.speed = 1
        """Robot seconds in one second. A lease lasts real time, so it is longer in robot time by this factor."""
        self.repertoire = repertoire
        """Actions that the teacher can run; no other part uses them while speeds are driven by hand."""
        self._present_until = -1
        self._press_ids: dict[str, int] = {}
        self._ended_press_ids: dict[str, int] = {}
        self._speeds: WheelSpeeds | None = None
        self.drive_seen_tick = -1
        """Tick of the state that the teacher saw when giving the newest speeds by hand; -1 before the first."""
        self._driven_until = -1
        self._behaviour: Behaviour | None = None
        self._behaviour_name = ""
        self._behaviour_until = -1
        self.held_press: int | None = None
        """Press id of the action that the teacher holds; None if none is held."""
        self._holds: dict[str, int] = {}
        """Newest press id of each teacher that was a hold."""

    def refusal_for(self, teacher: str) -> Outcome | None:
        """Return the refusal for a teacher without authority; None for the one who has it, and if no teacher has."""
        if self.teacher is None or self.teacher == teacher:
            return None
        return Outcome.of(RefusalCode.ANOTHER_TEACHES, teacher=self.teacher)

    def claim(self, teacher: str) -> None:
        """Give authority to `teacher` if no teacher has it; call it for every command that is carried out."""
        if self.teacher is None:
            self._set_teacher(teacher)

    def take_over(self, teacher: str, tick: int) -> Outcome | None:
        """Give authority to `teacher` instead of another; return a refusal while that one drives by hand.

        Returns None if `teacher` has authority now. `tick`: present tick.
        """
        if self.teacher not in (None, teacher) and self.is_manual(tick):
            return Outcome.of(RefusalCode.DRIVES_BY_HAND, teacher=self.teacher)
        if self.teacher != teacher:
            self._set_teacher(teacher)
        return None

    def hand_over(self, to: str | None) -> None:
        """Give authority to another teacher, or to none (None), and end manual drive.

        The new teacher must be present before the robot drives on.
        """
        self._set_teacher(to)

    def renew_presence(self, teacher: str, tick: int, seen_tick: int) -> None:
        """Renew the lease of presence by a message that arrived in `tick`, if its teacher has authority.

        `seen_tick`: tick of the state that the teacher saw when giving it.
        """
        if teacher == self.teacher:
            self._present_until = max(self._present_until, self.lease_end(tick, seen_tick))

    def extend_leases(self, ticks: int) -> None:
        """Extend every lease by missed ticks, in which the robot could not move or read messages."""
        self._present_until += ticks
        self._driven_until += ticks
        self._behaviour_until += ticks

    def is_present(self, tick: int) -> bool:
        """Return whether the teacher is present; always True if none is required."""
        return not self.attended or tick < self._present_until

    def drives_by_later_press(self, teacher: str, press_id: int, tick: int) -> bool:
        """Return whether this teacher drives in `tick` by a later press than `press_id`."""
        return self.is_manual(tick) and self.teacher == teacher and self._press_ids.get(teacher, -1) > press_id

    def reset_sequence(self, teacher: str) -> None:
        """Forget a teacher's press ids, because their device has new keys and counts presses from the start."""
        self._press_ids.pop(teacher, None)
        self._ended_press_ids.pop(teacher, None)
        self._holds.pop(teacher, None)

    def is_press_over(self, command: Drive | HoldAction) -> bool:
        """Return whether a stop, silence or a later press has ended this press, so that the message is a late one."""
        ended, newest = self._ended_press_ids.get(command.teacher, -1), self._press_ids.get(command.teacher, -1)
        return command.press_id <= ended or command.press_id < newest

    @property
    def absence_stop(self) -> ActiveStop:
        """Stop of a robot that drove and whose teacher is absent."""
        if self.teacher is None:
            return ActiveStop(StopReason.NO_TEACHER)
        reason = StopReason.LINK_LOST if self._present_until >= 0 else StopReason.TEACHER_NOT_YET
        return ActiveStop(reason, self.teacher)

    def drive(self, command: Drive, tick: int) -> None:
        """Set the speeds of manual drive and renew its lease.

        Call it only for the teacher with authority and a press that is not over.
        """
        if self._holds.get(command.teacher) == command.press_id:
            del self._holds[command.teacher]
        self._press_ids[command.teacher] = command.press_id
        self._behaviour = self.held_press = None
        self._speeds = WheelSpeeds(command.left_m_s, command.right_m_s)
        self.drive_seen_tick = command.seen_tick
        self._driven_until = self.lease_end(tick, command.seen_tick)
        self.renew_presence(command.teacher, tick, command.seen_tick)

    def hold(self, command: HoldAction, tick: int) -> None:
        """Let the held action drive and renew its lease.

        Call it only for the teacher with authority, a press that is not over and an action of the repertoire.
        """
        self._press_ids[command.teacher] = self._holds[command.teacher] = command.press_id
        if self.held_press != command.press_id or self._behaviour_name != command.action:
            self._start(command.action)
        self.held_press = command.press_id
        self._behaviour_until = self.lease_end(tick, command.seen_tick)
        self.renew_presence(command.teacher, tick, command.seen_tick)

    @property
    def held_action(self) -> str:
        """Action that the teacher holds; empty if none is held."""
        return "" if self.held_press is None else self._behaviour_name

    @property
    def held_until(self) -> int:
        """Tick in which the lease of the held action is over."""
        return self._behaviour_until

    @property
    def driving_press(self) -> tuple[str, int] | None:
        """Teacher and press id of the manual drive; None if no speeds are driven by hand."""
        if self._speeds is None or self.teacher is None:
            return None
        return self.teacher, self._press_ids[self.teacher]

    def is_hold(self, teacher: str, press_id: int) -> bool:
        """Return whether a press is the newest hold of this teacher or an older one; a newer press is none yet."""
        return press_id <= self._holds.get(teacher, -1)

    def run(self, action: str, tick: int, ticks: int) -> None:
        """Let an action drive for `ticks` ticks from `tick` on, while the teacher is present.

        Raises KeyError for an action outside the repertoire.
        """
        self._start(action)
        self._behaviour_until = tick + ticks

    def end_manual(self) -> None:
        """End manual drive and every press so far, so that late messages of them have no effect."""
        self._ended_press_ids.update(self._press_ids)
        self._speeds = None
        self._behaviour = self.held_press = None

    def is_manual(self, tick: int) -> bool:
        """Return whether the teacher drives by hand or runs an action in this tick."""
        if self._speeds is not None:
            return tick < self._driven_until
        return self._behaviour is not None and tick < self._behaviour_until and self.is_present(tick)

    def expire(self, tick: int) -> None:
        """End a press or a run whose lease is over in this tick; call it on every tick before the decision."""
        if (self._speeds is not None or self._behaviour is not None) and not self.is_manual(tick):
            self.end_manual()

    def step(self, readings: SensorReadings) -> tuple[str, WheelSpeeds]:
        """Return the name and the wheel speeds of the manual drive; call it only while `is_manual`."""
        if self._speeds is not None:
            return _BY_HAND, self._speeds
        assert self._behaviour is not None
        return self._behaviour_name, self._behaviour.step(readings)

    def _start(self, action: str) -> None:
        self._speeds = self.held_press = None
        self._behaviour = self.repertoire[action]
        self._behaviour.start()
        self._behaviour_name = action

    def _set_teacher(self, teacher: str | None) -> None:
        self.end_manual()
        self.teacher = teacher
        self._present_until = -1

    def lease_end(self, tick: int, seen_tick: int) -> int:
        """Return the tick in which the lease of a message is over that arrives in `tick`.

        `seen_tick`: tick of the state that the teacher saw when giving it.
        """
        return min(tick + _LEASE_TICKS * self.speed, seen_tick + _PICTURE_TICKS * self.speed)


def name_refusal(name: str) -> Outcome | None:
    """Return the refusal of a teacher's name that the journal would take for the critic's; None if it is allowed."""
    return Outcome.of(RefusalCode.CRITICS_NAME, name=name) if name == CRITIC else None
