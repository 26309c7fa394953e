"""Command handler: carries out the teacher's commands in the tick that takes them."""

from collections.abc import Iterable, Sequence
from itertools import compress
from typing import TypeGuard

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.lesson_speed import LessonSpeed
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import InvalidEventError, TeachingEvent
from kurt2rt.core.rla.lesson_history import DERIVED
from kurt2rt.core.rla.rla import AUTONOMOUS, BASIC, MID, Origin, Phase
from kurt2rt.core.teaching.authority import ControlAuthority, StopRecord, name_refusal
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
    SetLessonSpeed,
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
from kurt2rt.core.teaching.control_commands import ControlCommands, SessionClock
from kurt2rt.core.teaching.driven_lessons import Demonstration, HoldLessons
from kurt2rt.core.teaching.knowledge_updater import HandlerParts, KnowledgeUpdater, LessonResult
from kurt2rt.core.teaching.late_press import CHUNK_TICKS, LatePresses, RewindHistory, TeacherDelay
from kurt2rt.core.teaching.lesson_builder import LessonBuilder
from kurt2rt.core.teaching.message_fields import SLOWEST_PERCENT
from kurt2rt.core.teaching.mid_commands import BehaviourSelection, MidCommands

_Answer = tuple[CommandResult, tuple[TeachingEvent, ...]]
_TAUGHT_PHASES = (Phase.SUPERVISED, Phase.CORRECTIONS)
"""Phases in which the robot is taught actions."""

_BLOCKING = (DecisionCause.STOPPED, DecisionCause.BLIND, DecisionCause.UNSAVED, DecisionCause.UNATTENDED)
"""Causes that forbid the RLAs to drive; a robot stands for the first that holds."""


class CommandHandler:
    """Handler of the teachers' commands, which the tick takes from the inbox and hands over one by one.

    It carries out lessons, rewards, appraisals, undo, sessions, phases, goals, stop and resume.
    """

    def __init__(
        self,
        level: BasicLevel,
        authority: ControlAuthority,
        *,
        insert_radius_fraction: float,
        handled_command_ids: Iterable[str],
        parts: HandlerParts | None = None,
        teacher_available: bool = True,
        ask_radius_fraction: float = 1.0,
    ) -> None:
        """Connect the level, the authority and the optional parts.

        Args:
            insert_radius_fraction: a correction farther than this share of R from the nearest condition inserts an RLA.
            handled_command_ids: ids of earlier runs, whose commands are not carried out again.
            teacher_available: False if there is no teacher to ask, as in an exam.
            ask_radius_fraction: fraction of R beyond which the robot asks while it is taught, in phases 1 and 2.
        """
        parts = parts or HandlerParts()
        self.level = level
        self.teacher_available = teacher_available
        """False if there is no teacher to ask."""
        self._ask_radius_fraction = ask_radius_fraction
        self.active_behaviour = level.active_behaviour
        self.authority = authority
        self.critic = parts.critic
        self.agreement = parts.agreement
        self.reinforcement = reinforcement = parts.reinforcement
        self.mid = parts.mid
        self._learner = parts.learner
        self.recent = DecisionHistory(level.system.dimensions) if reinforcement is None else reinforcement.recent
        self._rewind = RewindHistory(self.recent)
        self._lessons = LessonBuilder(level, self.recent, self._rewind, insert_radius_fraction, parts)
        self.corrections_at = self._lessons.corrections_at
        """Number of corrections in this run, by level."""
        self.delay = parts.delay or TeacherDelay()
        self.holds = HoldLessons(self._lessons, level.system, self.recent, self.delay)
        self.demonstration = Demonstration(self._lessons, level.system, authority.repertoire, self.recent)
        self.stops = StopRecord()
        self.control = ControlCommands(level.repertoire, authority, self.stops, self.holds, self.delay)
        self._late = LatePresses(self.recent, self.delay)
        self.updater = KnowledgeUpdater(level, handled_command_ids, parts)
        self.phase = Phase.SUPERVISED
        self.lesson_speed = LessonSpeed(parts.lesson_speed)
        self._selection = BehaviourSelection(self.active_behaviour, parts.mid)
        self.clock = SessionClock()

    def was_handled(self, command_id: str) -> bool:
        """Return whether a command of this id was carried out already."""
        return command_id in self.updater.handled_ids

    @property
    def learner_failure(self) -> str | None:
        """Failure of the learner that decides instead of the RLAs, in one line; None without one."""
        return None if self._learner is None else self._learner.team.failure or None

    def before_decision(self, tick: int, *, was_driving: bool, turned: bool) -> None:
        """Stop a robot that drove and whose required teacher is absent; call it before each decision.

        Without a teacher to ask, the level skips RLAs whose action was withdrawn. A robot that is taught asks sooner.
        The decisions of ticks in which a wheel turned are kept for a teacher who rewinds.

        `was_driving`: whether an action drove in the tick before. `turned`: whether a wheel turned in it.
        """
        if turned is not self._rewind.driving or tick % CHUNK_TICKS == 0:
            self._rewind.update(driving=turned)
        self.level.skip_withdrawn = not self.teacher_available or self.phase is AUTONOMOUS
        self.level.counts = self.lesson_speed.counts
        taught = self.is_taught
        self.level.system.radius_share = self._ask_radius_fraction if taught else 1.0
        if self._learner is not None:
            self._learner.counts, self._learner.taught = self.lesson_speed.counts, taught
        authority = self.authority
        if was_driving and self.stops.active is None and self.requires_teacher and not authority.is_present(tick):
            self.control.stop(authority.absence_stop)

    def causes_to_stand(self, tick: int, *, blind: bool, unsaved: bool) -> tuple[DecisionCause, ...]:
        """Return the causes that forbid the RLAs to drive in a tick, highest priority first.

        `blind`: whether the range sensors are silent. `unsaved`: whether lessons cannot be saved.
        """
        unattended = self.requires_teacher and not self.authority.is_present(tick)
        holds = (self.stops.active is not None, blind, unsaved, unattended)
        return tuple(compress(_BLOCKING, holds)) if True in holds else ()

    @property
    def is_taught(self) -> bool:
        """Return whether a teacher is there who answers, in a phase in which the robot asks sooner."""
        return self.teacher_available and self.phase in _TAUGHT_PHASES

    @property
    def slows_actions(self) -> bool:
        """Return whether an action that drives now is slowed: by a teacher, in phases 1 and 2.

        Speeds that the teacher drives by hand are not.
        """
        return (
            self.lesson_speed.share < 1.0
            and self.is_taught
            and self.authority.teacher is not None
            and self.authority.driving_press is None
        )

    @property
    def requires_teacher(self) -> bool:
        """Return whether the robot drives by its RLAs only while a teacher is present."""
        return self.authority.attended and self.phase is not AUTONOMOUS

    def sample_manual_drive(self, tick: int, readings: SensorReadings, speeds: WheelSpeeds) -> None:
        """Sample speeds that the teacher drives by hand in this tick; an action that runs is no demonstration."""
        authority = self.authority
        press = authority.driving_press
        if press is None:
            return
        teacher, _ = press
        reacted = authority.drive_seen_tick - self.delay.hand_ticks(teacher, authority.speed)
        self.demonstration.update(tick, press, readings, speeds, reacted)

    def teach_driven(self, tick: int) -> Sequence[TeachingEvent]:
        """Apply and return the lessons that a held action and a confirmed demonstration give in this tick.

        Call it only if lessons can be saved, and submit the events to the journal.
        """
        if self.authority.held_press is None and not self.demonstration.pending:
            return ()
        events: list[TeachingEvent] = []
        shown = self.demonstration.next_lesson(tick)
        if shown is not None:
            self.updater.apply_own(shown, events)
        held = self.control.hold_lesson(tick, self.phase)
        if held is not None:
            self.updater.apply_own(held, events)
        return events

    def on_decision(self, tick: int, *, asks: bool) -> None:
        """Note whether the basic level asked its teacher in a tick, to measure the teacher's delay."""
        if asks or self.delay.asked_tick is not None:
            self.delay.on_decision(tick, asks=asks, present=self.authority.is_present(tick))

    def handle(self, command: Command, situation: Situation, tick: int) -> _Answer:
        """Carry out one command in this tick; return its result and the events that it caused, oldest first.

        The events are applied already and must be submitted to the journal. A refusal is a result, no error.
        `situation`: of this tick. `command`: no message of a stream; those go to `control`.
        """
        assert not isinstance(command, Stream)
        # Every copy of a stop brakes: a copy may be the one that matters.
        stops_again = isinstance(command, Stop) and command.press_id is None
        if self.was_handled(command.command_id) and not stops_again:
            return CommandResult(command.command_id, Outcome(ResultCode.REPEATED)), ()
        if DERIVED in command.command_id and not isinstance(command, Stop):
            why = Outcome.of(RefusalCode.RESERVED_ID, command_id=command.command_id, sign=DERIVED)
            return CommandResult(command.command_id, why), ()
        was_free = self.authority.teacher is None
        dated = self._late.assign(command, self.authority.speed)
        try:
            outcome, event, before = self._carry_out(dated, situation, tick)
            events = before if event is None else (*before, event)
            for each in events:
                self.updater.apply(each)
            self._on_lesson(dated, tick, taught=event is not None)
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
        outcome = self._late.described(dated, outcome)
        return CommandResult(command.command_id, outcome, lesson=event is not None), events

    def _on_lesson(self, command: Command, tick: int, *, taught: bool) -> None:
        """Note a lesson: at the mid level it replaces the override, at the basic level it may answer a question."""
        if not isinstance(command, Teach | Correct):
            return
        if command.level == MID and self.mid is not None:
            self.mid.on_lesson(command)
        if not taught or command.level != BASIC:
            return
        asked, meant = self.delay.asked_tick, command.decision_tick
        self.delay.last_asked_tick = None
        if asked is not None and (meant is None or meant >= asked):
            given = tick if command.seen_tick is None else command.seen_tick
            self.delay.on_answer(command.teacher, given, self.authority.speed)

    def _carry_out(self, command: Command, situation: Situation, tick: int) -> LessonResult:
        if isinstance(command, Stop):
            return LessonResult(self.control.carry_out(command, tick))
        refuse(name_refusal(command.teacher))
        if isinstance(command, Take):
            return LessonResult(self.control.carry_out(command, tick))
        refuse(self.authority.refusal_for(command.teacher))
        self.authority.claim(command.teacher)
        if _lifts_stop(command):
            refuse(self.stops.refusal_since(command.seen_tick))
        match command:
            case HandOver() | Resume() | RunBehaviour():
                return LessonResult(self.control.carry_out(command, tick))
            case SetPhase():
                return LessonResult(self._set_phase(command))
            case SetLessonSpeed(percent=percent):
                return LessonResult(self._set_lesson_speed(percent))
            case Pursue():
                return LessonResult(self._selection.select(command, tick))
            case Seek() | StopSeeking() | BeAt():
                return LessonResult(self._require_mid().carry_out(command, tick))
            case NameSituation():
                return LessonResult(*self._require_mid().name_situation(command, self._origin(command, tick)))
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

    def _set_lesson_speed(self, percent: int) -> Outcome:
        if not SLOWEST_PERCENT <= percent <= 100:
            raise CommandRefusedError(RefusalCode.NO_LESSON_SPEED, percent=percent, least=SLOWEST_PERCENT)
        self.lesson_speed.share = percent / 100
        return Outcome.of(ResultCode.LESSON_SPEED_SET, percent=percent)

    def _set_phase(self, command: SetPhase) -> Outcome:
        self.phase = command.phase
        return Outcome.of(ResultCode.PHASE_SET, phase=command.phase.value, name=command.phase.name.lower())

    def _require_mid(self) -> MidCommands:
        if self.mid is None:
            raise CommandRefusedError(RefusalCode.NO_MID_LEVEL)
        return self.mid

    def _session(self, command: BeginSession | EndSession, tick: int) -> tuple[Outcome, TeachingEvent]:
        name = self.clock.session
        taken = self.clock.apply(command, tick, self._origin(command, tick))
        if isinstance(command, EndSession):
            # An earlier reason stays: the end of a session must not hide a teacher's stop.
            self.control.stop(self.stops.active or ActiveStop(StopReason.SESSION_OVER, name or ""), command.teacher)
        return taken

    def _origin(self, command: Command, tick: int) -> Origin:
        assert not isinstance(command, Stream)
        return Origin(command.command_id, command.teacher, self.phase, tick)


def _lifts_stop(command: Command) -> TypeGuard[Resume | SetPhase | Pursue | Seek | StopSeeking]:
    """Return whether a command may set a robot in motion, or change its way, so that a later stop refuses it."""
    if isinstance(command, SetPhase):
        return command.phase is Phase.AUTONOMOUS
    return isinstance(command, Resume | Pursue | Seek | StopSeeking)
