"""Carries out the teacher's commands, in the tick that takes them."""

from collections import deque
from collections.abc import Iterable

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Critic, Opinion
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.rla.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Origin, Phase, Rla, TeachingEvent
from kurt2rt.core.rla.rla_system import InvalidEventError
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.behaviour_selection import BehaviourSelection
from kurt2rt.core.teaching.commands import (
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
from kurt2rt.core.teaching.goal_commands import GoalCommands
from kurt2rt.core.teaching.knowledge_updater import KnowledgeUpdater
from kurt2rt.core.teaching.lesson_builder import LessonBuilder, require_action
from kurt2rt.core.teaching.mid_lessons import MidLessons
from kurt2rt.core.teaching.rewards import RewardCommands
from kurt2rt.core.teaching.session_clock import TeachingClock
from kurt2rt.core.teaching.taught import Taught

DERIVED = "/"
"""In the ids of what comes of a signal; a teacher's id with it might be one that the robot gives later."""

_COPIES_OF = 32
"""Newest stops whose copies are known; a copy of an older one counts as a stop of its own, which only refuses more."""

_Answer = tuple[CommandResult, TeachingEvent | None]


class CommandHandler:
    """What teachers may do: lessons, rewards, appraisals and undo, sessions, phases, stop and resume."""

    def __init__(
        self,
        level: BasicLevel,
        authority: ControlAuthority,
        *,
        insert_beyond_share: float,
        taken_command_ids: Iterable[str],
        reinforcement: Reinforcement | None = None,
        critic: Critic | None = None,
        agreement: Agreement | None = None,
        self_teaching: SelfTeaching | None = None,
        mid: MidLessons | None = None,
        errands: GoalCommands | None = None,
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
        self.recent = DecisionHistory(level.system.dimensions) if reinforcement is None else reinforcement.recent
        self._tuition = LessonBuilder(
            level,
            self.recent,
            insert_beyond_share=insert_beyond_share,
            reinforcement=reinforcement,
            appraising=None if critic is None else RewardCommands(critic, level.system, self.recent),
            mid=mid,
        )
        self.learning = KnowledgeUpdater(
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
        self._pursuing = BehaviourSelection(self.wanted, mid)
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

    def follow(self, command: Watch | Drive, tick: int) -> Outcome | None:
        """Apply a message of a stream, of which only the newest counts; return a refusal."""
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

    def why_not_by_hand(self, command: Watch | Drive) -> Outcome | None:
        """Return why this press does not drive the robot; None if it does. Being there is always allowed."""
        if isinstance(command, Watch):
            return None
        if self.authority.is_over(command):
            return Outcome(RefusalCode.PRESS_OVER)
        return self._stopped_by_another(command.teacher)

    def stopped_since(self, seen_tick: int | None) -> Outcome | None:
        """Return why a command given on the picture of this tick must not lift a stop; None if no stop came since."""
        if seen_tick is None or seen_tick >= self.stopped_at_tick:
            return None
        return Outcome(RefusalCode.STOPPED_SINCE)

    def attend(self, command: Command, situation: Situation, tick: int) -> _Answer:
        """Carry out one command. An event in the answer already acts and has to reach the journal."""
        assert not isinstance(command, Watch | Drive)
        # A stop that comes twice stops twice: it may be the second one that is meant.
        stops_again = isinstance(command, Stop) and command.hold is None
        if self.has_taken(command.command_id) and not stops_again:
            return CommandResult(command.command_id, Outcome(ResultCode.REPEATED)), None
        if DERIVED in command.command_id and not isinstance(command, Stop):
            why = Outcome.of(RefusalCode.RESERVED_ID, command_id=command.command_id, sign=DERIVED)
            return CommandResult(command.command_id, why), None
        nobody_taught = self.authority.teacher is None
        try:
            outcome, event = self._carry_out(command, situation, tick)
            if event is not None:
                self.learning.apply(event)
            self._heed(command)
        except (CommandRefusedError, InvalidEventError) as error:
            if nobody_taught and self.authority.teacher is not None:
                self.authority.hand_over(None)  # who was refused has not become the teacher by it
            why = (
                error.outcome
                if isinstance(error, CommandRefusedError)
                else Outcome.of(RefusalCode.DOES_NOT_FIT, says=str(error))
            )
            return CommandResult(command.command_id, why), None
        self.learning.taken.add(command.command_id)
        return CommandResult(command.command_id, outcome, lesson=event is not None), event

    def _heed(self, command: Command) -> None:
        """What was taught about the present goes before what the teacher had commanded for it."""
        if self.mid is not None and isinstance(command, Teach | Correct) and command.level == MID:
            self.mid.taught(command)

    def learn(self, tick: int, decision: Decision, opinion: Opinion | None) -> list[TeachingEvent]:
        """What is learnt from a tick when the wheels have been told; see `KnowledgeUpdater.from_tick`."""
        return self.learning.from_tick(self.phase, tick, decision, opinion)

    def _carry_out(self, command: Command, situation: Situation, tick: int) -> Taught:
        authority = self.authority
        if isinstance(command, Stop):
            return Taught(self._stop(command, tick))
        refuse(_no_person(command.teacher))
        if isinstance(command, Take):
            before = authority.teacher
            refuse(authority.take(command.teacher, tick))
            self._pass_on(before)
            return Taught(Outcome.of(ResultCode.TAKEN, teacher=command.teacher))
        refuse(authority.held_by_another(command.teacher))
        authority.claim(command.teacher)
        match command:
            case HandOver(to=to):
                refuse(None if to is None else _no_person(to))
                authority.hand_over(to)
                self._pass_on(command.teacher)
                released = Outcome(ResultCode.RELEASED)
                return Taught(released if to is None else Outcome.of(ResultCode.HANDED_OVER, teacher=to))
            case Resume():
                refuse(self.stopped_since(command.seen_tick))
                self.stopped = None
                self._stopped_by.clear()
                self._stops_since_go.clear()
                authority.end_hand()
                return Taught(Outcome(ResultCode.RESUMED))
            case SetPhase():
                if command.phase is Phase.AUTONOMOUS:
                    refuse(self.stopped_since(command.seen_tick))
                self.phase = command.phase
                phase = command.phase
                return Taught(Outcome.of(ResultCode.PHASE_SET, phase=phase.value, name=phase.name.lower()))
            case Pursue():
                refuse(self.stopped_since(command.seen_tick))
                return Taught(self._pursuing.take(command, tick))
            case Seek() | StopSeeking():
                refuse(self.stopped_since(command.seen_tick))
                return Taught(self._errands_of().carry_out(command, tick))
            case BeAt():
                return Taught(self._errands_of().carry_out(command, tick))
            case NameSituation():
                return Taught(*self._errands_of().name(command, self._origin(command, tick)))
            case RunBehaviour():
                return Taught(self._run(command, tick))
            case BeginSession() | EndSession():
                return Taught(*self._session(command, tick))
            case Watch() | Drive():
                raise AssertionError("streams are followed, not carried out")
            case _:
                return self._tuition.event_of(command, situation, self._origin(command, tick))

    def _stop(self, command: Stop, tick: int) -> Outcome:
        if command.hold is not None and self.authority.drives_on(command.teacher, command.hold, tick):
            return Outcome(ResultCode.RELEASE_SUPERSEDED)
        # A copy brakes again, but nobody has said it anew: who says go has seen what it was a copy of.
        if command.command_id not in self._stops_since_go:
            self._stops_since_go.append(command.command_id)
            self.stopped_at_tick = tick
        reason = StopReason.SAID_STOP if command.hold is None else StopReason.LET_GO
        self.stop(ActiveStop(reason, command.teacher), command.teacher)
        return Outcome(ResultCode.STOPPED)

    def _errands_of(self) -> GoalCommands:
        if self._errands is None:
            raise CommandRefusedError(RefusalCode.NO_MID_LEVEL)
        return self._errands

    def _pass_on(self, before: str | None) -> None:
        """The robot stays stopped, but the next teacher may drive it by hand though the one before had stopped it."""
        if before is not None:
            self._stopped_by.discard(before)

    def _run(self, command: RunBehaviour, tick: int) -> Outcome:
        require_action(command.action, self._level.repertoire)
        refuse(self.stopped_since(command.seen_tick) or self._stopped_by_another(command.teacher))
        if not self.authority.present(tick):
            raise CommandRefusedError(RefusalCode.TEACHER_ABSENT)
        self.stop(ActiveStop(StopReason.BEHAVIOUR_OVER, command.action), command.teacher)
        self.authority.run(command.action, tick, command.ticks)
        return Outcome.of(ResultCode.ACTION_RUNS, action=command.action, ticks=command.ticks)

    def _session(self, command: BeginSession | EndSession, tick: int) -> tuple[Outcome, TeachingEvent]:
        name = self.session
        taken = self._clock.take(command, tick, self._origin(command, tick))
        if isinstance(command, EndSession):
            # A reason that is there already stays: the end of a session must not hide that somebody said stop.
            self.stop(self.stopped or ActiveStop(StopReason.SESSION_OVER, name or ""), command.teacher)
        return taken

    def _stopped_by_another(self, teacher: str) -> Outcome | None:
        others = tuple(sorted(self._stopped_by - {teacher}))
        return Outcome.of(RefusalCode.STOPPED_BY, teachers=others) if others else None

    def _origin(self, command: Command, tick: int) -> Origin:
        assert not isinstance(command, Watch | Drive)
        return Origin(command.command_id, command.teacher, self.phase, tick)


def _no_person(name: str) -> Outcome | None:
    """Return why a teacher must not have this name: the journal would take their lessons for the critic's."""
    return Outcome.of(RefusalCode.CRITICS_NAME, name=name) if name == CRITIC else None
