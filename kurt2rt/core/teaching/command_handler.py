"""Command handler: carries out the teacher's commands in the tick that takes them."""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Critic, Opinion
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.rla.event_error import InvalidEventError
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.lesson_history import DERIVED
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Origin, Rla
from kurt2rt.core.teaching.appraisal_lessons import AppraisalLessons
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
    HoldAction,
    NameSituation,
    Pursue,
    Resume,
    RunBehaviour,
    Seek,
    SetPhase,
    Stop,
    StopSeeking,
    Stream,
    Take,
    Teach,
    TeachShown,
    Undo,
    Watch,
)
from kurt2rt.core.teaching.demonstration import Demonstration
from kurt2rt.core.teaching.goal_commands import GoalCommands
from kurt2rt.core.teaching.hold_lessons import HoldLessons
from kurt2rt.core.teaching.knowledge_updater import KnowledgeUpdater
from kurt2rt.core.teaching.late_press import LatePresses
from kurt2rt.core.teaching.lesson_builder import LessonBuilder, require_action
from kurt2rt.core.teaching.lesson_result import LessonResult
from kurt2rt.core.teaching.mid_lessons import MidLessons
from kurt2rt.core.teaching.rewind_history import RewindHistory
from kurt2rt.core.teaching.session_clock import SessionClock
from kurt2rt.core.teaching.teacher_delay import TeacherDelay

_KNOWN_STOPS = 32
"""Number of stops whose copies are recognised; a copy of an older one counts as another stop, which is safe."""

_Answer = tuple[CommandResult, tuple[TeachingEvent, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class HandlerParts:
    """Optional parts of a command handler, each None if the task lacks it."""

    reinforcement: Reinforcement | None = None
    """Effect of rewards; None: they have none."""
    critic: Critic | None = None
    agreement: Agreement | None = None
    self_teaching: SelfTeaching | None = None
    """Teacher of phase 5; None: the robot learns nothing then."""
    mid: MidLessons | None = None
    """Lessons of the mid level; None: the teacher alone selects the behaviour."""
    goals: GoalCommands | None = None
    delay: TeacherDelay | None = None
    """Delay of the teachers; None: it begins with the default."""


class CommandHandler:
    """Handler of lessons, rewards, appraisals, undo, sessions, phases, goals, stop and resume."""

    def __init__(
        self,
        level: BasicLevel,
        authority: ControlAuthority,
        *,
        insert_beyond_share: float,
        handled_command_ids: Iterable[str],
        parts: HandlerParts | None = None,
        teacher_available: bool = True,
    ) -> None:
        """Connect the level, the authority and the optional parts.

        Args:
            insert_beyond_share: a correction farther than this share of R from the nearest condition inserts an RLA.
            handled_command_ids: ids of earlier runs, whose commands are not carried out again.
            teacher_available: False if there is no teacher to ask, as in an exam.
        """
        parts = parts or HandlerParts()
        self._level = level
        self.teacher_available = teacher_available
        """False if there is no teacher to ask."""
        self.active_behaviour = level.active_behaviour
        self.authority = authority
        self.critic = parts.critic
        self.agreement = parts.agreement
        self.reinforcement = reinforcement = parts.reinforcement
        self.mid = parts.mid
        self._goals = parts.goals
        self.recent = DecisionHistory(level.system.dimensions) if reinforcement is None else reinforcement.recent
        self._rewind = RewindHistory(self.recent)
        self._lessons = _lesson_builder(level, self.recent, self._rewind, insert_beyond_share, parts)
        self.delay = parts.delay or TeacherDelay()
        self.holds = HoldLessons(self._lessons, level.system, self.recent, self.delay)
        self.demonstration = Demonstration(self._lessons, level.system, authority.repertoire)
        self._late = LatePresses(self.recent, self.delay)
        self.updater = _knowledge_updater(level, handled_command_ids, parts)
        self.phase = Phase.SUPERVISED
        self.active_stop: ActiveStop | None = None
        """Stop that lasts until `Resume`; None without one."""
        self._stopped_by: set[str] = set()
        self.stopped_at_tick = -1
        """Tick of the last stop by a teacher or the guard; a command given on an older state must not lift it."""
        self._stops_since_resume: deque[str] = deque(maxlen=_KNOWN_STOPS)
        self._selection = BehaviourSelection(self.active_behaviour, parts.mid)
        self._clock = SessionClock()

    def was_handled(self, command_id: str) -> bool:
        """Return whether a command of this id was carried out already."""
        return command_id in self.updater.handled_ids

    @property
    def corrections(self) -> int:
        """Return the number of corrections of the basic level."""
        return self.corrections_at(BASIC)

    def corrections_at(self, level_name: str) -> int:
        """Return the number of corrections of a level."""
        return self._lessons.corrections_at[level_name]

    def stop(self, stop: ActiveStop, by: str | None = None) -> None:
        """Stand until `Resume`.

        Args:
            stop: reason for the active stop.
            by: teacher who stopped the robot and may still drive it by hand; other teachers may not. After stops by
                two teachers neither may, because a late copy of one's stop must not lift the other's.
        """
        self.authority.end_manual()
        self.active_stop = stop
        if by is not None:
            self._stopped_by.add(by)

    @property
    def active_rlas(self) -> tuple[Rla, ...]:
        """Return all active RLAs of all levels, in no order."""
        return self._level.system.active_rlas

    @property
    def session(self) -> str | None:
        """Return the name of the open session; None without one."""
        return self._clock.session

    def teaching_ticks(self, tick: int) -> int:
        """Return the length of the open session at `tick`, or of the last one, in ticks."""
        return self._clock.ticks(tick)

    def before_decision(self, tick: int, *, was_driving: bool) -> None:
        """Stop a robot that drove and whose required teacher is absent; call it before each decision.

        Without a teacher to ask, the level skips RLAs whose action was withdrawn. The decisions before a standstill are
        kept for a teacher who rewinds.
        """
        self._rewind.update(driving=was_driving)
        self._level.skip_withdrawn = not self.teacher_available or self.phase is Phase.AUTONOMOUS
        authority = self.authority
        if was_driving and self.active_stop is None and self.requires_teacher and not authority.is_present(tick):
            self.stop(authority.absence_stop)

    @property
    def requires_teacher(self) -> bool:
        """Return whether the robot drives by its RLAs only while a teacher is present."""
        return self.authority.attended and self.phase is not Phase.AUTONOMOUS

    def handle_stream(self, command: Stream, tick: int) -> Outcome | None:
        """Apply a message of a stream, in which only the newest counts; return a refusal, or None."""
        authority = self.authority
        refusal = _no_person(command.teacher) or authority.refusal_for(command.teacher) or self.manual_refusal(command)
        if refusal is not None:
            return refusal
        if isinstance(command, Watch):
            authority.renew_presence(command.teacher, tick, command.seen_tick)
            return None
        authority.claim(command.teacher)
        if isinstance(command, HoldAction):
            self._hold(command, tick)
            return None
        authority.drive(command, tick)
        # After manual drive the robot stands until a resume, also when messages cease.
        self.active_stop = ActiveStop(StopReason.LET_GO, command.teacher)
        self._stopped_by = {command.teacher}
        return None

    def _hold(self, command: HoldAction, tick: int) -> None:
        if self.authority.held_press == command.press_id:
            self.holds.on_message(command, tick)
        else:
            self.holds.begin(command, tick, self.authority.speed)
            self.delay.on_answer(command.teacher, command.seen_tick, self.authority.speed)
        self.authority.hold(command, tick)

    def teach_driven(self, tick: int) -> list[TeachingEvent]:
        """Apply and return the lessons that a held action and a confirmed demonstration give in this tick.

        Call it only if lessons can be saved.
        """
        events: list[TeachingEvent] = []
        shown = self.demonstration.next_lesson(tick)
        if shown is not None:
            self.updater.apply_own(shown, events)
        if self.authority.held_press is not None and self.authority.is_manual(tick):
            event = self.holds.build(tick, self.phase, self.authority.speed)
            if event is not None:
                self.updater.apply_own(event, events)
        return events

    def on_decision(self, tick: int, *, asks: bool) -> None:
        """Note whether the basic level asked its teacher in a tick."""
        self.delay.on_decision(tick, asks=asks, present=self.authority.is_present(tick))

    def manual_refusal(self, command: Stream) -> Outcome | None:
        """Return why this press does not drive the robot; None if it does, and for a sign of presence."""
        if isinstance(command, Watch):
            return None
        if self.authority.is_press_over(command):
            return Outcome(RefusalCode.PRESS_OVER)
        if isinstance(command, HoldAction):
            if command.action not in self._level.repertoire:
                return Outcome.of(RefusalCode.NO_ACTION, action=command.action, known=tuple(self._level.repertoire))
            return None if self.active_stop is None else Outcome(RefusalCode.ROBOT_STOPPED)
        return self._refusal_if_stopped_by_another(command.teacher)

    def refusal_if_stopped_since(self, seen_tick: int | None) -> Outcome | None:
        """Return the refusal of a command given on the state of `seen_tick` if a stop came since; None otherwise."""
        if seen_tick is None or seen_tick >= self.stopped_at_tick:
            return None
        return Outcome(RefusalCode.STOPPED_SINCE)

    def handle(self, command: Command, situation: Situation, tick: int) -> _Answer:
        """Carry out one command; an event in the answer is applied already and must be submitted to the journal."""
        assert not isinstance(command, Stream)
        # Every copy of a stop brakes: a copy may be the one that matters.
        stops_again = isinstance(command, Stop) and command.press_id is None
        if self.was_handled(command.command_id) and not stops_again:
            return CommandResult(command.command_id, Outcome(ResultCode.REPEATED)), ()
        if DERIVED in command.command_id and not isinstance(command, Stop):
            why = Outcome.of(RefusalCode.RESERVED_ID, command_id=command.command_id, sign=DERIVED)
            return CommandResult(command.command_id, why), ()
        was_free = self.authority.teacher is None
        meant = self._late.put_back(command, self.authority.speed)
        try:
            outcome, event, before = self._carry_out(meant, situation, tick)
            events = before if event is None else (*before, event)
            for each in events:
                self.updater.apply(each)
            self._notify_mid_level(meant)
            self._note_answer(meant, tick, taught=event is not None)
        except (CommandRefusedError, InvalidEventError) as error:
            if was_free and self.authority.teacher is not None:
                self.authority.hand_over(None)  # a refused command gives no authority
            why = (
                error.outcome
                if isinstance(error, CommandRefusedError)
                else Outcome.of(RefusalCode.DOES_NOT_FIT, says=event_error_text(error))
            )
            return CommandResult(command.command_id, why), ()
        self.updater.handled_ids.add(command.command_id)
        outcome = self._late.described(meant, outcome)
        return CommandResult(command.command_id, outcome, lesson=event is not None), events

    def _note_answer(self, command: Command, tick: int, *, taught: bool) -> None:
        """Note a lesson that answers the basic level's present question."""
        if not taught or not isinstance(command, Teach | Correct) or command.level != BASIC:
            return
        asked, meant = self.delay.asked_tick, command.decision_tick
        if asked is not None and (meant is None or meant >= asked):
            given = tick if command.seen_tick is None else command.seen_tick
            self.delay.on_answer(command.teacher, given, self.authority.speed)

    def _notify_mid_level(self, command: Command) -> None:
        """Tell the mid level of a lesson, which replaces the teacher's override of the present situation."""
        if self.mid is not None and isinstance(command, Teach | Correct) and command.level == MID:
            self.mid.on_lesson(command)

    def learn(self, tick: int, decision: Decision, opinion: Opinion | None) -> list[TeachingEvent]:
        """Learn from a tick after its wheel speeds were sent; see `KnowledgeUpdater.learn_from_tick`."""
        return self.updater.learn_from_tick(self.phase, tick, decision, opinion)

    def _carry_out(self, command: Command, situation: Situation, tick: int) -> LessonResult:
        authority = self.authority
        if isinstance(command, Stop):
            return LessonResult(self._stop(command, tick))
        refuse(_no_person(command.teacher))
        if isinstance(command, Take):
            before = authority.teacher
            refuse(authority.take_over(command.teacher, tick))
            self._clear_stop_of(before)
            return LessonResult(Outcome.of(ResultCode.TAKEN, teacher=command.teacher))
        refuse(authority.refusal_for(command.teacher))
        authority.claim(command.teacher)
        match command:
            case HandOver(to=to):
                refuse(None if to is None else _no_person(to))
                authority.hand_over(to)
                self._clear_stop_of(command.teacher)
                released = Outcome(ResultCode.RELEASED)
                return LessonResult(released if to is None else Outcome.of(ResultCode.HANDED_OVER, teacher=to))
            case Resume():
                refuse(self.refusal_if_stopped_since(command.seen_tick))
                return LessonResult(self._resume())
            case SetPhase():
                if command.phase is Phase.AUTONOMOUS:
                    refuse(self.refusal_if_stopped_since(command.seen_tick))
                self.phase = command.phase
                phase = command.phase
                return LessonResult(Outcome.of(ResultCode.PHASE_SET, phase=phase.value, name=phase.name.lower()))
            case Pursue():
                refuse(self.refusal_if_stopped_since(command.seen_tick))
                return LessonResult(self._selection.select(command, tick))
            case Seek() | StopSeeking():
                refuse(self.refusal_if_stopped_since(command.seen_tick))
                return LessonResult(self._require_goals().carry_out(command, tick))
            case BeAt():
                return LessonResult(self._require_goals().carry_out(command, tick))
            case NameSituation():
                return LessonResult(*self._require_goals().name_situation(command, self._origin(command, tick)))
            case RunBehaviour():
                return LessonResult(self._run(command, tick))
            case TeachShown():
                origin = self._origin(command, tick)
                return LessonResult(self.demonstration.confirm(command.press_id, command.segments, origin))
            case BeginSession() | EndSession():
                return LessonResult(*self._session(command, tick))
            case Watch() | Drive() | HoldAction():
                raise AssertionError("streams are followed, not carried out")
            case _:
                if isinstance(command, Undo):
                    self.demonstration.cancel()
                return self._lessons.build(command, situation, self._origin(command, tick))

    def _resume(self) -> Outcome:
        self.active_stop = None
        self._stopped_by.clear()
        self._stops_since_resume.clear()
        self.authority.end_manual()
        return Outcome(ResultCode.RESUMED)

    def _stop(self, command: Stop, tick: int) -> Outcome:
        if command.press_id is not None and self.authority.drives_by_later_press(
            command.teacher, command.press_id, tick
        ):
            return Outcome(ResultCode.RELEASE_SUPERSEDED)
        if command.press_id is not None and self.authority.is_hold(command.teacher, command.press_id):
            return self._release_hold(command.press_id)
        # A copy brakes again but is not a newer stop: the teacher who resumes has seen the original.
        if command.command_id not in self._stops_since_resume:
            self._stops_since_resume.append(command.command_id)
            self.stopped_at_tick = tick
        reason = StopReason.SAID_STOP if command.press_id is None else StopReason.LET_GO
        self.stop(ActiveStop(reason, command.teacher), command.teacher)
        return Outcome(ResultCode.STOPPED)

    def _release_hold(self, press_id: int) -> Outcome:
        """End a hold, so that the RLAs drive on; a late release of an ended hold changes nothing."""
        if self.authority.held_press == press_id:
            self.authority.end_manual()
        hold = self.holds.newest
        if hold is None or hold.press_id != press_id or hold.lessons == 0:
            return Outcome.of(ResultCode.HOLD_RELEASED, lessons=0, lesson=None)
        return Outcome.of(ResultCode.HOLD_RELEASED, lessons=hold.lessons, lesson=hold.lesson)

    def _require_goals(self) -> GoalCommands:
        if self._goals is None:
            raise CommandRefusedError(RefusalCode.NO_MID_LEVEL)
        return self._goals

    def _clear_stop_of(self, before: str | None) -> None:
        """Let the next teacher drive by hand although the one before stopped the robot, which stays stopped."""
        if before is not None:
            self._stopped_by.discard(before)

    def _run(self, command: RunBehaviour, tick: int) -> Outcome:
        require_action(command.action, self._level.repertoire)
        refuse(self.refusal_if_stopped_since(command.seen_tick) or self._refusal_if_stopped_by_another(command.teacher))
        if not self.authority.is_present(tick):
            raise CommandRefusedError(RefusalCode.TEACHER_ABSENT)
        self.stop(ActiveStop(StopReason.BEHAVIOUR_OVER, command.action), command.teacher)
        self.authority.run(command.action, tick, command.ticks)
        return Outcome.of(ResultCode.ACTION_RUNS, action=command.action, ticks=command.ticks)

    def _session(self, command: BeginSession | EndSession, tick: int) -> tuple[Outcome, TeachingEvent]:
        name = self.session
        taken = self._clock.apply(command, tick, self._origin(command, tick))
        if isinstance(command, EndSession):
            # An earlier reason stays: the end of a session must not hide a teacher's stop.
            self.stop(self.active_stop or ActiveStop(StopReason.SESSION_OVER, name or ""), command.teacher)
        return taken

    def _refusal_if_stopped_by_another(self, teacher: str) -> Outcome | None:
        others = tuple(sorted(self._stopped_by - {teacher}))
        return Outcome.of(RefusalCode.STOPPED_BY, teachers=others) if others else None

    def _origin(self, command: Command, tick: int) -> Origin:
        assert not isinstance(command, Stream)
        return Origin(command.command_id, command.teacher, self.phase, tick)


def _no_person(name: str) -> Outcome | None:
    """Return why a teacher must not have this name: the journal would take their lessons for the critic's."""
    return Outcome.of(RefusalCode.CRITICS_NAME, name=name) if name == CRITIC else None


def _knowledge_updater(level: BasicLevel, handled_ids: Iterable[str], parts: HandlerParts) -> KnowledgeUpdater:
    return KnowledgeUpdater(
        level,
        handled_command_ids=handled_ids,
        reinforcement=parts.reinforcement,
        agreement=parts.agreement,
        self_teaching=parts.self_teaching,
    )


def _lesson_builder(
    level: BasicLevel,
    recent: DecisionHistory,
    rewind: RewindHistory,
    insert_beyond_share: float,
    parts: HandlerParts,
) -> LessonBuilder:
    appraisal_lessons = None if parts.critic is None else AppraisalLessons(parts.critic, level.system, recent)
    return LessonBuilder(
        level,
        recent,
        rewind,
        insert_beyond_share=insert_beyond_share,
        reinforcement=parts.reinforcement,
        appraisal_lessons=appraisal_lessons,
        mid=parts.mid,
    )
