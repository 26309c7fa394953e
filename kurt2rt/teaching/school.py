"""Carries out the teacher's commands, in the tick that takes them."""

from collections import deque
from collections.abc import Iterable

from kurt2rt.critic.agreement import Agreement
from kurt2rt.critic.critic import Critic, Opinion
from kurt2rt.layers.basic_level import BasicLevel
from kurt2rt.layers.decision import Decision
from kurt2rt.perception.perception import Situation
from kurt2rt.reinforcement.reinforcement import Reinforcement
from kurt2rt.reinforcement.self_teaching import SelfTeaching
from kurt2rt.rla.rla import BASIC, CRITIC, MID, Origin, Phase, Rla, TeachingEvent
from kurt2rt.rla.rla_system import InvalidEventError
from kurt2rt.teaching.active_stop import ActiveStop, StopReason
from kurt2rt.teaching.appraising import Appraising
from kurt2rt.teaching.authority import Authority
from kurt2rt.teaching.commands import (
    BeAt,
    BeginSession,
    Command,
    CommandResult,
    Correct,
    Drive,
    EndSession,
    HandOver,
    NameSituation,
    Pursue,
    Resume,
    RunBehaviour,
    Seek,
    SetPhase,
    Stop,
    StopSeeking,
    Take,
    Teach,
    Watch,
)
from kurt2rt.teaching.errands import ErrandCommand, Errands
from kurt2rt.teaching.learning import Learning
from kurt2rt.teaching.mid_lessons import MidLessons
from kurt2rt.teaching.pursuing import Pursuing
from kurt2rt.teaching.recent import RecentDecisions
from kurt2rt.teaching.refused import RefusedError, refuse
from kurt2rt.teaching.teaching_clock import TeachingClock
from kurt2rt.teaching.tuition import Tuition, require_action

DERIVED = "/"
"""In the ids of what comes of a signal; a teacher's id with it might be one that the robot gives later."""

_COPIES_OF = 32
"""Newest stops whose copies are known; a copy of an older one counts as a stop of its own, which only refuses more."""

_Answer = tuple[CommandResult, TeachingEvent | None]


class School:
    """What teachers may do: lessons, rewards, appraisals and undo, sessions, phases, stop and resume."""

    def __init__(
        self,
        level: BasicLevel,
        authority: Authority,
        *,
        insert_beyond_share: float,
        taken_command_ids: Iterable[str],
        reinforcement: Reinforcement | None = None,
        critic: Critic | None = None,
        agreement: Agreement | None = None,
        self_teaching: SelfTeaching | None = None,
        mid: MidLessons | None = None,
        errands: Errands | None = None,
        asked: bool = True,
    ) -> None:
        """Without `reinforcement` nothing is learnt from rewards, without `self_teaching` nothing in phase 5.

        Without `mid` the teacher alone says what is wanted; without `errands` there are no goals.

        `asked`: False where nobody is there who could be asked, as in an exam.
        """
        self._level = level
        self.asked = asked
        """Whether there is a teacher to ask."""
        self.wanted = level.wanted
        self.authority = authority
        self.critic = critic
        self.agreement = agreement
        self.reinforcement = reinforcement
        self.mid = mid
        self._errands = errands
        self.recent = RecentDecisions(level.system.dimensions) if reinforcement is None else reinforcement.recent
        self._tuition = Tuition(
            level,
            self.recent,
            insert_beyond_share=insert_beyond_share,
            reinforcement=reinforcement,
            appraising=None if critic is None else Appraising(critic, level.system, self.recent),
            mid=mid,
        )
        self.learning = Learning(
            level,
            taken_command_ids=taken_command_ids,
            reinforcement=reinforcement,
            agreement=agreement,
            self_teaching=self_teaching,
        )
        self.phase = Phase.SUPERVISED
        self.stopped: ActiveStop | None = None
        """The stop that holds until `Resume`; None while none does."""
        self._stopped_by: set[str] = set()
        self.stopped_at_tick = -1
        """When a teacher last said stop, or the guard did: what was said on an older picture must not lift it."""
        self._stops_since_go: deque[str] = deque(maxlen=_COPIES_OF)
        self._pursuing = Pursuing(self.wanted, mid)
        self._clock = TeachingClock()

    def has_taken(self, command_id: str) -> bool:
        """Whether a command of this id was carried out already."""
        return command_id in self.learning.taken

    @property
    def corrections(self) -> int:
        """How often a teacher has corrected the basic level."""
        return self.corrections_at(BASIC)

    def corrections_at(self, level: str) -> int:
        """How often a teacher has corrected a level."""
        return self._tuition.corrections_at[level]

    def stop(self, stop: ActiveStop, by: str | None = None) -> None:
        """Stand until `Resume`. `by`: a teacher, who may still drive by hand; another one may not.

        Stopped by two, neither may: a late copy of one's stop must not lift the other's.
        """
        self.authority.end_hand()
        self.stopped = stop
        if by is not None:
            self._stopped_by.add(by)

    @property
    def living(self) -> tuple[Rla, ...]:
        """All RLAs that live, of all levels, in no order."""
        return self._level.system.living

    @property
    def session(self) -> str | None:
        """Name of the session that is on."""
        return self._clock.session

    def teaching_ticks(self, tick: int) -> int:
        """How long the session that is on has lasted at `tick`, or how long the last one did."""
        return self._clock.ticks(tick)

    def look_after(self, tick: int, *, was_driving: bool) -> None:
        """Before each decision: a robot that drove and has lost its teacher stands until it is told to resume.

        Where nobody is asked, RLAs whose action was withdrawn are passed over.
        """
        self._level.nobody_is_asked = not self.asked or self.phase is Phase.AUTONOMOUS
        authority = self.authority
        if was_driving and self.stopped is None and self.needs_a_teacher and not authority.present(tick):
            self.stop(authority.absence)

    @property
    def needs_a_teacher(self) -> bool:
        """Whether the robot may drive by its RLAs only while a teacher is there."""
        return self.authority.attended and self.phase is not Phase.AUTONOMOUS

    def follow(self, command: Watch | Drive, tick: int) -> str | None:
        """Take in a message of a stream, of which only the newest counts; a refusal in words."""
        authority = self.authority
        refusal = (
            _no_person(command.teacher) or authority.held_by_another(command.teacher) or self.why_not_by_hand(command)
        )
        if refusal is not None:
            return refusal
        if isinstance(command, Watch):
            authority.watch(command.teacher, tick, command.seen_tick)
            return None
        authority.claim(command.teacher)
        authority.drive(command, tick)
        # When the hand lets go, or is not heard any more, the robot stands; the RLAs go on when told to.
        self.stopped = ActiveStop(StopReason.LET_GO, command.teacher)
        self._stopped_by = {command.teacher}
        return None

    def why_not_by_hand(self, command: Watch | Drive) -> str | None:
        """Why this press does not drive the robot, in a sentence; None when it does. Being there is always allowed."""
        if isinstance(command, Watch):
            return None
        if self.authority.is_over(command):
            return "this press is over; let go and press anew"
        return self._stopped_by_another(command.teacher)

    def stopped_since(self, seen_tick: int | None) -> str | None:
        """Why what was said on the picture of this tick, and comes after a stop, must neither lift that nor change what
        comes after it; None where no stop came between.
        """
        if seen_tick is None or seen_tick >= self.stopped_at_tick:
            return None
        return "the robot was stopped after this was said; look at it, then say it again"

    def attend(self, command: Command, situation: Situation, tick: int) -> _Answer:
        """Carry out one command. An event in the answer already acts and has to reach the journal."""
        assert not isinstance(command, Watch | Drive)
        # A stop that comes twice stops twice: it may be the second one that is meant.
        stops_again = isinstance(command, Stop) and command.hold is None
        if self.has_taken(command.command_id) and not stops_again:
            return CommandResult(command.command_id, True, "had been taken already; counted once"), None
        if DERIVED in command.command_id and not isinstance(command, Stop):
            why = f"the id {command.command_id!r} has a {DERIVED}, which only ids of the robot's own have; leave it out"
            return CommandResult(command.command_id, False, why), None
        nobody_taught = self.authority.teacher is None
        try:
            text, event = self._carry_out(command, situation, tick)
            if event is not None:
                self.learning.apply(event)
            self._heed(command)
        except (RefusedError, InvalidEventError) as error:
            if nobody_taught and self.authority.teacher is not None:
                self.authority.hand_over(None)  # who was refused has not become the teacher by it
            return CommandResult(command.command_id, False, str(error)), None
        self.learning.taken.add(command.command_id)
        return CommandResult(command.command_id, True, text, lesson=event is not None), event

    def _heed(self, command: Command) -> None:
        """What was taught about the present goes before what the teacher had commanded for it."""
        if self.mid is not None and isinstance(command, Teach | Correct) and command.level == MID:
            self.mid.taught(command)

    def learn(self, tick: int, decision: Decision, opinion: Opinion | None) -> list[TeachingEvent]:
        """What is learnt from a tick when the wheels have been told; see `Learning.from_tick`."""
        return self.learning.from_tick(self.phase, tick, decision, opinion)

    def _carry_out(self, command: Command, situation: Situation, tick: int) -> tuple[str, TeachingEvent | None]:
        authority = self.authority
        if isinstance(command, Stop):
            return self._stop(command, tick), None
        refuse(_no_person(command.teacher))
        if isinstance(command, Take):
            before = authority.teacher
            refuse(authority.take(command.teacher, tick))
            self._pass_on(before)
            return f"{command.teacher} teaches", None
        refuse(authority.held_by_another(command.teacher))
        authority.claim(command.teacher)
        match command:
            case HandOver(to=to):
                refuse(None if to is None else _no_person(to))
                authority.hand_over(to)
                self._pass_on(command.teacher)
                return "nobody teaches now" if to is None else f"{to} teaches now", None
            case Resume():
                refuse(self.stopped_since(command.seen_tick))
                self.stopped = None
                self._stopped_by.clear()
                self._stops_since_go.clear()
                authority.end_hand()
                return "the robot may drive", None
            case SetPhase():
                if command.phase is Phase.AUTONOMOUS:
                    refuse(self.stopped_since(command.seen_tick))
                self.phase = command.phase
                return f"phase {command.phase.value}, {command.phase.name.lower()}", None
            case Pursue():
                refuse(self.stopped_since(command.seen_tick))
                return self._pursuing.take(command, tick), None
            case Seek() | StopSeeking():
                refuse(self.stopped_since(command.seen_tick))
                return self._errands_of(command).carry_out(command, tick), None
            case BeAt():
                return self._errands_of(command).carry_out(command, tick), None
            case NameSituation():
                return self._errands_of(command).name(command, self._origin(command, tick))
            case RunBehaviour():
                return self._run(command, tick), None
            case BeginSession() | EndSession():
                return self._session(command, tick)
            case Watch() | Drive():
                raise AssertionError("streams are followed, not carried out")
            case _:
                return self._tuition.event_of(command, situation, self._origin(command, tick))

    def _stop(self, command: Stop, tick: int) -> str:
        if command.hold is not None and self.authority.drives_on(command.teacher, command.hold, tick):
            return "that press is over; a later one drives"
        # A copy brakes again, but nobody has said it anew: who says go has seen what it was a copy of.
        if command.command_id not in self._stops_since_go:
            self._stops_since_go.append(command.command_id)
            self.stopped_at_tick = tick
        reason = StopReason.SAID_STOP if command.hold is None else StopReason.LET_GO
        self.stop(ActiveStop(reason, command.teacher), command.teacher)
        return "the robot stands until it is told to resume"

    def _errands_of(self, command: ErrandCommand) -> Errands:
        if self._errands is None:
            raise RefusedError(f"{type(command).__name__}: this robot has no mid level that could go anywhere")
        return self._errands

    def _pass_on(self, before: str | None) -> None:
        """The robot stays stopped, but the next teacher may drive it by hand though the one before had stopped it."""
        if before is not None:
            self._stopped_by.discard(before)

    def _run(self, command: RunBehaviour, tick: int) -> str:
        require_action(command.action, self._level.repertoire)
        refuse(self.stopped_since(command.seen_tick) or self._stopped_by_another(command.teacher))
        if not self.authority.present(tick):
            raise RefusedError("a behaviour runs only while its teacher is there and watches")
        self.stop(ActiveStop(StopReason.BEHAVIOUR_OVER, command.action), command.teacher)
        self.authority.run(command.action, tick, command.ticks)
        return f"{command.action} for {command.ticks} ticks"

    def _session(self, command: BeginSession | EndSession, tick: int) -> tuple[str, TeachingEvent]:
        name = self.session
        taken = self._clock.take(command, tick, self._origin(command, tick))
        if isinstance(command, EndSession):
            # A reason that is there already stays: the end of a session must not hide that somebody said stop.
            self.stop(self.stopped or ActiveStop(StopReason.SESSION_OVER, name or ""), command.teacher)
        return taken

    def _stopped_by_another(self, teacher: str) -> str | None:
        others = sorted(self._stopped_by - {teacher})
        return f"{' and '.join(others)} stopped the robot; say resume first" if others else None

    def _origin(self, command: Command, tick: int) -> Origin:
        assert not isinstance(command, Watch | Drive)
        return Origin(command.command_id, command.teacher, self.phase, tick)


def _no_person(name: str) -> str | None:
    """Why nobody of this name teaches: the journal would take what he says for what the critic does."""
    return f"{name} is the name of the robot's own critic; teach under another one" if name == CRITIC else None
