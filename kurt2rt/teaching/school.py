"""Carries out the teacher's commands, in the tick that takes them."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from kurt2rt.critic.agreement import Agreement
from kurt2rt.critic.critic import Critic
from kurt2rt.layers.basic_level import BasicLevel
from kurt2rt.perception.perception import Situation
from kurt2rt.rla.rla import (
    ActionReplaced,
    LessonUndone,
    Origin,
    Phase,
    Rla,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    TeachingEvent,
)
from kurt2rt.rla.rla_system import UnfitEventError
from kurt2rt.teaching.authority import Authority
from kurt2rt.teaching.commands import (
    Appraise,
    BeginSession,
    Command,
    CommandResult,
    Correct,
    DeleteRla,
    Drive,
    EndSession,
    HandOver,
    Pursue,
    ReplaceAction,
    Resume,
    Reward,
    RunBehaviour,
    SetPhase,
    Stop,
    Take,
    Teach,
    Undo,
    Watch,
)
from kurt2rt.teaching.recent import RecentDecisions

_Answer = tuple[CommandResult, TeachingEvent | None]


class _RefusedError(Exception):
    """Why a command is not carried out, in a sentence for the teacher."""


class School:
    """What teachers may do: RLAs made, corrected, deleted, rewarded and undone, sessions, phases, stop and resume."""

    def __init__(
        self,
        level: BasicLevel,
        authority: Authority,
        *,
        insert_beyond_share: float,
        taken_command_ids: Iterable[str],
        critic: Critic | None = None,
        agreement: Agreement | None = None,
    ) -> None:
        self._level = level
        self.wanted = level.wanted
        self.authority = authority
        self.critic = critic
        self.agreement = agreement
        self.recent = RecentDecisions(level.system.dimensions)
        self._insert_beyond_share = insert_beyond_share
        self._taken = set(taken_command_ids)
        self.phase = Phase.SUPERVISED
        self.stopped_because = ""
        """Empty while nobody stopped the robot."""
        self._stopped_by: set[str] = set()
        self._pursued_seen_tick = -1
        """What the teacher had seen when he said what is wanted now."""
        self.stopped_at_tick = -1
        """When a teacher last said stop, or the guard did: what was said on an older picture must not lift it."""
        self.corrections = 0
        self.session: str | None = None
        """Name of the session that is on."""
        self._session_from = 0
        self._session_ticks = 0

    def has_taken(self, command_id: str) -> bool:
        """Whether a command of this id was carried out already."""
        return command_id in self._taken

    def stop(self, because: str, by: str | None = None) -> None:
        """Stand until `Resume`. `by`: a teacher, who may still drive by hand; another one may not.

        Stopped by two, neither may: a late copy of one's stop must not lift the other's.
        """
        self.authority.end_hand()
        self.stopped_because = because
        if by is not None:
            self._stopped_by.add(by)

    def teaching_ticks(self, tick: int) -> int:
        """How long the session that is on has lasted at `tick`, or how long the last one did."""
        return self._session_ticks if self.session is None else tick - self._session_from

    def look_after(self, tick: int, *, was_driving: bool) -> None:
        """Before each decision: a robot that drove and has lost its teacher stands until it is told to resume."""
        authority = self.authority
        if was_driving and not self.stopped_because and self.needs_a_teacher and not authority.present(tick):
            self.stop(authority.why_absent)

    @property
    def needs_a_teacher(self) -> bool:
        """Whether the robot may drive by its RLAs only while a teacher is there."""
        return self.authority.attended and self.phase is not Phase.AUTONOMOUS

    def follow(self, command: Watch | Drive, tick: int) -> str | None:
        """Take in a message of a stream, of which only the newest counts; a refusal in words."""
        authority = self.authority
        refusal = authority.held_by_another(command.teacher) or self.why_not_by_hand(command)
        if refusal is not None:
            return refusal
        if isinstance(command, Watch):
            authority.watch(command.teacher, tick, command.seen_tick)
            return None
        authority.claim(command.teacher)
        authority.drive(command, tick)
        # When the hand lets go, or is not heard any more, the robot stands; the RLAs go on when told to.
        self.stopped_because = _let_go(command.teacher)
        self._stopped_by = {command.teacher}
        return None

    def why_not_by_hand(self, command: Watch | Drive) -> str | None:
        """Why this press does not drive the robot, in a sentence; None when it does. Being there is always allowed."""
        if isinstance(command, Watch):
            return None
        if self.authority.is_over(command):
            return "this press was ended by a stop; let go and press anew"
        return self._stopped_by_another(command.teacher)

    def attend(self, command: Command, situation: Situation, tick: int) -> _Answer:
        """Carry out one command. An event in the answer already acts and has to reach the journal."""
        assert not isinstance(command, Watch | Drive)
        # A stop that comes twice stops twice: it may be the second one that is meant.
        stops_again = isinstance(command, Stop) and command.hold is None
        if self.has_taken(command.command_id) and not stops_again:
            return CommandResult(command.command_id, True, "had been taken already; counted once"), None
        nobody_taught = self.authority.teacher is None
        try:
            text, event = self._carry_out(command, situation, tick)
            if event is not None:
                self._level.apply(event)
        except (_RefusedError, UnfitEventError) as error:
            if nobody_taught and self.authority.teacher is not None:
                self.authority.hand_over(None)  # who was refused has not become the teacher by it
            return CommandResult(command.command_id, False, str(error)), None
        self._taken.add(command.command_id)
        return CommandResult(command.command_id, True, text, lesson=event is not None), event

    def _carry_out(self, command: Command, situation: Situation, tick: int) -> tuple[str, TeachingEvent | None]:
        authority = self.authority
        if isinstance(command, Stop):
            return self._stop(command, tick), None
        if isinstance(command, Take):
            before = authority.teacher
            self._refuse(authority.take(command.teacher, tick))
            self._pass_on(before)
            return f"{command.teacher} teaches", None
        self._refuse(authority.held_by_another(command.teacher))
        authority.claim(command.teacher)
        match command:
            case HandOver(to=to):
                authority.hand_over(to)
                self._pass_on(command.teacher)
                return "nobody teaches now" if to is None else f"{to} teaches now", None
            case Resume():
                self._refuse(self._stopped_since(command))
                self.stopped_because = ""
                self._stopped_by.clear()
                authority.end_hand()
                return "the robot may drive", None
            case SetPhase():
                if command.phase is Phase.AUTONOMOUS:
                    self._refuse(self._stopped_since(command))
                self.phase = command.phase
                return f"phase {command.phase.value}, {command.phase.name.lower()}", None
            case Pursue():
                return self._pursue(command, tick), None
            case RunBehaviour():
                return self._run(command, tick), None
            case BeginSession() | EndSession():
                return self._session(command, tick)
            case Teach() | Correct():
                return self._lesson(command, situation, tick)
            case ReplaceAction():
                self._require_action(command.action)
                return self._replace(command, command.rla_id, tick)
            case DeleteRla():
                title = self._require_rla(command.rla_id).title
                return f"{title} deleted", RlaDeleted(command.rla_id, self._origin(command, tick))
            case Reward():
                return self._reward(command, tick)
            case Appraise():
                raise _RefusedError("this robot has no critic")
            case Undo():
                return self._undo(command, tick)
            case Watch() | Drive():
                raise AssertionError("streams are followed, not carried out")

    def _stop(self, command: Stop, tick: int) -> str:
        if command.hold is not None and self.authority.drives_on(command.teacher, command.hold, tick):
            return "that press is over; a later one drives"
        self.stopped_at_tick = tick
        self.stop(
            _let_go(command.teacher) if command.hold is not None else f"{command.teacher} said stop", command.teacher
        )
        return "the robot stands until it is told to resume"

    def _pursue(self, command: Pursue, tick: int) -> str:
        self._refuse(self._stopped_since(command))
        seen_tick = tick if command.seen_tick is None else command.seen_tick
        if seen_tick < self._pursued_seen_tick:
            raise _RefusedError(
                f"{self.wanted.behaviour or 'the only behaviour'} was asked for after this was said; "
                "look at the robot, then say it again"
            )
        try:
            self.wanted.pursue(command.behaviour)
        except ValueError as error:
            raise _RefusedError(str(error)) from error
        self._pursued_seen_tick = seen_tick
        return f"{command.behaviour or 'the only behaviour'} is wanted"

    def _pass_on(self, before: str | None) -> None:
        """The robot stays stopped, but the next teacher may drive it by hand though the one before had stopped it."""
        if before is not None:
            self._stopped_by.discard(before)

    def _run(self, command: RunBehaviour, tick: int) -> str:
        self._require_action(command.action)
        self._refuse(self._stopped_since(command) or self._stopped_by_another(command.teacher))
        if not self.authority.present(tick):
            raise _RefusedError("a behaviour runs only while its teacher is there and watches")
        self.stop(f"{command.action} is over", command.teacher)
        self.authority.run(command.action, tick, command.ticks)
        return f"{command.action} for {command.ticks} ticks"

    def _session(self, command: BeginSession | EndSession, tick: int) -> tuple[str, TeachingEvent]:
        origin = self._origin(command, tick)
        if isinstance(command, BeginSession):
            if self.session is not None:
                raise _RefusedError(f"the session {self.session!r} is on; end it first")
            self.session, self._session_from = command.name, tick
            return f"session {command.name!r} begins", SessionBegun(command.name, origin)
        if self.session is None:
            raise _RefusedError("no session is on")
        name, self._session_ticks = self.session, self.teaching_ticks(tick)
        self.session = None
        # A reason that is there already stays: the end of a session must not hide that somebody said stop.
        self.stop(self.stopped_because or f"the session {name!r} is over", command.teacher)
        return f"session {name!r} is over; the robot stands", SessionEnded(self._session_ticks, origin)

    def _lesson(self, command: Teach | Correct, situation: Situation, tick: int) -> tuple[str, TeachingEvent | None]:
        self._require_action(command.action)
        meant, behaviour = situation.vector, self.wanted.behaviour
        if command.decision_tick is not None:
            self._require_known(command.decision_tick)
            if not self.recent.saw(command.decision_tick):
                raise _RefusedError("the infra-red sensors were silent then, so there is no situation to teach")
            meant = self.recent.situation(command.decision_tick)
            behaviour = self.recent.behaviour(command.decision_tick)
        # On the very condition of an RLA a second one would never win: the older one does.
        replace_within_share = 0.0
        if isinstance(command, Correct):
            self.corrections += 1
            replace_within_share = self._insert_beyond_share
        nearest = self._level.system.match(meant, behaviour)
        if nearest is None or nearest.distance > replace_within_share * nearest.radius:
            return self._create(command, meant, behaviour, tick)
        if nearest.rla.action == command.action:
            return f"{nearest.rla.title} says {command.action} already", None
        return self._replace(command, nearest.rla.rla_id, tick)

    def _create(
        self, command: Teach | Correct, meant: NDArray[np.float64], behaviour: str, tick: int
    ) -> tuple[str, TeachingEvent | None]:
        rla = Rla(
            rla_id=self._level.system.next_id,
            condition=tuple(meant.tolist()),
            action=command.action,
            radius=None,
            origin=self._origin(command, tick),
            behaviour=behaviour,
        )
        return f"{rla.title} taught: {rla.action}", RlaCreated(rla)

    def _replace(
        self, command: Teach | Correct | ReplaceAction, rla_id: int, tick: int
    ) -> tuple[str, TeachingEvent | None]:
        rla = self._require_rla(rla_id)
        event = ActionReplaced(rla_id, command.action, rla.action, self._origin(command, tick))
        return f"{rla.title} corrected: {command.action} instead of {rla.action}", event

    def _reward(self, command: Reward, tick: int) -> tuple[str, TeachingEvent]:
        meant = command.decision_tick
        if meant is None:
            meant = self.recent.newest  # not the tick before this one, which may have been missed
        self._require_known(meant)
        rla_id = self.recent.rla(meant)
        if rla_id is None:
            raise _RefusedError("no RLA drove the robot then; there is nothing to reward or to punish")
        title = self._require_rla(rla_id).title
        word = "rewarded" if command.value > 0 else "punished"
        return f"{title} {word}", RlaRewarded(rla_id, command.value, meant, self._origin(command, tick))

    def _undo(self, command: Undo, tick: int) -> tuple[str, TeachingEvent]:
        lesson = command.lesson or self._level.system.last_standing_lesson
        if lesson is None:
            raise _RefusedError("there is no lesson to undo")
        why_not = self._level.system.why_not_undo(lesson)
        self._refuse(why_not)
        record = self._level.system.lesson(lesson)
        assert record is not None
        return f"undone: {record.text}", LessonUndone(lesson, self._origin(command, tick))

    def _require_action(self, action: str) -> None:
        if action not in self._level.repertoire:
            known = ", ".join(self._level.repertoire)
            raise _RefusedError(f"there is no action {action!r}; the repertoire has: {known}")

    def _require_rla(self, rla_id: int) -> Rla:
        rla = self._level.system.get(rla_id)
        if rla is None:
            raise _RefusedError(f"there is no RLA {rla_id}; it may have been deleted")
        return rla

    def _require_known(self, tick: int) -> None:
        if not self.recent.knows(tick):
            raise _RefusedError(f"the decision of tick {tick} is not remembered any more; look at the newest picture")

    def _stopped_by_another(self, teacher: str) -> str | None:
        others = sorted(self._stopped_by - {teacher})
        return f"{' and '.join(others)} stopped the robot; say resume first" if others else None

    def _stopped_since(self, command: Resume | RunBehaviour | SetPhase | Pursue) -> str | None:
        """What was said before a stop, and comes after it, must not lift it, nor change what comes after it."""
        if command.seen_tick is None or command.seen_tick >= self.stopped_at_tick:
            return None
        return "the robot was stopped after this was said; look at it, then say it again"

    def _refuse(self, reason: str | None) -> None:
        if reason is not None:
            raise _RefusedError(reason)

    def _origin(self, command: Command, tick: int) -> Origin:
        assert not isinstance(command, Watch | Drive)
        return Origin(command.command_id, command.teacher, self.phase, tick)


def _let_go(teacher: str) -> str:
    return f"{teacher} drove by hand and let go"
