"""The tick: order of all steps of one control cycle, 100 times a second."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import STANDSTILL, GuardResult, SensorReadings
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import ASKING, BY_KNOWLEDGE, Decision, DecisionCause, stopped
from kurt2rt.core.decision.open_question import OpenQuestion
from kurt2rt.core.decision.standing import (
    ActiveStop,
    BumperWatch,
    Standing,
    StandingWatch,
    StopReason,
    hindrance_after_resume,
)
from kurt2rt.core.expectations.expectations import Surprise
from kurt2rt.core.mid.mid_level import MidUsageCounter
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import AUTONOMOUS, BASIC
from kurt2rt.core.teaching.commands import BeAt, Command, CommandResult, Correct, Resume, Stream, Teach
from kurt2rt.core.teaching.inbox import Input, PairingRenewed, RobotRepositioned, SpeedChanged, SystemEvent
from kurt2rt.core.tick_parts import TickOptions, TickParts
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.tick_timer import Stage

# The results of the steps are made in every tick: a plain dataclass takes half the time of a named tuple.


@dataclass(slots=True)
class Perceived:
    """Result of the tick's step perceive: the situation, and the critic's view of it."""

    situation: Situation
    blind: bool
    appraisal_features: AppraisalFeatures | None
    opinion: Opinion | None


@dataclass(slots=True)
class Decided:
    """Result of the tick's step decide: the teachers' commands with their results, and the decision."""

    commands: tuple[Input, ...]
    results: list[CommandResult]
    events: list[TeachingEvent]
    """Lessons of the commands; the step learn adds the robot's own."""
    saving_error: str | None
    decision: Decision
    behaviour: str


@dataclass(slots=True)
class Guarded:
    """Result of the tick's step guard: the applied speeds, and whether the robot asks at a bumper."""

    result: GuardResult
    drove_at_s: float
    asks_at_bumper: bool
    turning: bool
    """True if the decided action turns the wheels."""


def tell_hindrance(
    results: Sequence[CommandResult], standing: Standing, guard_result: GuardResult
) -> tuple[CommandResult, ...]:
    """Return the results of a tick's commands; those of resumes say what still holds the robot, if anything does.

    `standing`: after the tick. `guard_result`: of the tick.
    """
    if not any(each.code is ResultCode.RESUMED for each in results):
        return tuple(results)
    hindrance = hindrance_after_resume(standing, guard_result)
    if hindrance is None:
        return tuple(results)
    told = Outcome.of(ResultCode.RESUMED, stands=hindrance.reason, says=hindrance.says)
    return tuple(replace(each, outcome=told) if each.code is ResultCode.RESUMED else each for each in results)


_KNOWLEDGE_PERIOD_TICKS = 100
"""A record holds all active RLAs at least this often."""

_SENSE, _PERCEIVE, _DECIDE, _GUARD, _LEARN, _PUBLISH = Stage
_TEACHER, _UNATTENDED = DecisionCause.TEACHER, DecisionCause.UNATTENDED
"""Names for each tick, because Python 3.11 looks a member up in its enumeration ten times slower than a global."""

_STOPS_HANDS = (DecisionCause.BLIND, DecisionCause.UNSAVED)
"""Causes by which not even a teacher drives by hand."""

_TEACHABLE = BY_KNOWLEDGE | ASKING
"""Causes of decisions that a held action may correct."""


class Tick:
    """One control cycle of 10 ms: bus -> sense -> perceive -> decide -> guard -> bus, then learn -> publish.

    Runtime, batch checks and replay call `run` once per tick.

    A deterministic function of its state, the readings and the commands: no wall clock, no unseeded chance, no I/O
    except the bus.
    """

    def __init__(self, parts: TickParts, options: TickOptions, *, now: Callable[[], float]) -> None:
        """Connect the parts; `now` returns the runtime clock's time in s."""
        self._robot = parts.robot
        self._perception = parts.perception
        self._appraisal_perception = parts.appraisal_perception
        self._level = parts.level
        self._handler = parts.handler
        self._inbox = parts.inbox
        self._event_store = parts.event_store
        self._statistics = parts.statistics
        self._mid_uses = MidUsageCounter(parts.statistics)
        self._expectations = parts.expectations
        self._sensor_watch = parts.sensor_watch
        self._substitute = parts.substitute
        self._turned = False
        """Whether the last CONTROL frame let a wheel turn."""
        self._timer = parts.timer
        self._options = options
        self._now = now
        self._driving = self._latched = False
        self._waits = False
        """Return whether the robot stood at a bumper in the last tick and waited for its teacher's answer."""
        self._bumpers = BumperWatch()
        self._standing = StandingWatch()
        self._question = OpenQuestion()
        self._saving_error: str | None = None
        self._publish_knowledge_at = 0
        self._number = 0
        self._last_tick: int | None = None

    def run(self, tick: int, now_s: float) -> TickRecord:
        """Run one tick at `now_s` of the runtime's clock, in s, and return its record."""
        self._count(tick)
        readings = self._sense(now_s)
        trusted = self._check_sensors(tick, readings)
        view = self._perceive(tick, trusted)
        choice = self._decide(tick, trusted, view)
        motion = self._guard(tick, now_s, choice.decision)
        surprise = self._learn(tick, view, choice, motion)
        record = self._publish(tick, now_s, readings, view, choice, motion, surprise)
        if trusted is readings or self._sensor_watch is None:
            return record
        return record._replace(broken_sensors=self._sensor_watch.broken, trusted_counts=trusted.infrared_counts)

    def _count(self, tick: int) -> None:
        """Count this tick, and extend the teacher's leases by missed ticks of a robot that stalls with the program."""
        self._number += 1
        if self._options.tolerates_stalls and self._last_tick is not None and tick > self._last_tick + 1:
            self._handler.authority.extend_leases(tick - self._last_tick - 1)
        self._last_tick = tick

    def _sense(self, now_s: float) -> SensorReadings:
        """Read the bus without waiting (step 1)."""
        readings = self._robot.sense(now_s)
        self._timer.lap(_SENSE)
        return readings

    def _check_sensors(self, tick: int, readings: SensorReadings) -> SensorReadings:
        """Return the readings without those of broken sensors; stop until a resume for a newly broken one."""
        watch, substitute = self._sensor_watch, self._substitute
        if watch is None or substitute is None:
            return readings
        if readings.infrared_age_s <= self._options.stale_infrared_s:
            # On the clock of the way, because an obstacle that explains a sign is passed more slowly.
            drove = self._turned and self._handler.lesson_speed.counts
            found = watch.update(readings, driving=drove)
            if found:
                names = ", ".join(sensor.title for sensor in found)
                self._handler.control.stop(ActiveStop(StopReason.SENSOR_BROKEN, names))
                self._handler.stops.newest_tick = tick
        if not watch.places:
            return readings
        return readings._replace(infrared_counts=substitute(readings.infrared_counts, watch.places))

    def _perceive(self, tick: int, readings: SensorReadings) -> Perceived:
        """Compute the situation, and the critic's opinion before this tick's commands can change it (step 2)."""
        # The averages stand still while the robot waits for its teacher: autonomy has no waits to learn from. In a slow
        # lesson they are those of the way at full speed.
        frozen = not self._driving or self._waits or not self._handler.lesson_speed.counts
        situation = self._perception.perceive(readings, history_frozen=frozen)
        blind = not readings.infrared_age_s <= self._options.stale_infrared_s
        features, opinion, critic = None, None, self._handler.critic
        if self._appraisal_perception is not None and critic is not None:
            perceived = self._appraisal_perception.perceive(readings, driving=self._driving and not self._waits)
            if not blind:
                features, opinion = perceived, critic.appraise(tick, perceived)
        self._timer.lap(_PERCEIVE)
        return Perceived(situation, blind, features, opinion)

    def _decide(self, tick: int, readings: SensorReadings, view: Perceived) -> Decided:
        """Handle the teacher's commands, then let the levels decide (step 3)."""
        commands = self._inbox.pop_all()
        results: list[CommandResult] = []
        events: list[TeachingEvent] = []
        for command in commands:
            if isinstance(command, Stream):
                self._handler.control.follow(command, tick)
            elif isinstance(command, PairingRenewed | SpeedChanged | RobotRepositioned):
                self._apply_system_event(command)
            else:
                result, taught = self._handle(command, tick, view)
                results.append(result)
                events.extend(taught)
        # Read once: the journal's thread may change it during the tick, and a replay has one value a tick.
        self._saving_error = self._event_store.saving_error
        if self._saving_error is None and not view.blind and not self._latched:
            events.extend(self._handler.teach_driven(tick))
        decision = self._decision(tick, view.situation, readings, blind=view.blind)
        self._timer.lap(_DECIDE)
        return Decided(
            commands, results, events, self._saving_error, decision, self._handler.active_behaviour.behaviour
        )

    def _guard(self, tick: int, now_s: float, decision: Decision) -> Guarded:
        """Send the decided speeds through the guard; note an emergency stop and a wait at a bumper (step 4)."""
        # A decision without an action never drives. The clock is read again, so that the guard sees a decision's
        # true age if the tick was held up.
        speeds, handler = decision.wheel_speeds if decision.driving else STANDSTILL, self._handler
        if decision.driving and handler.slows_actions:
            speeds = handler.lesson_speed.slow(speeds)
        elif handler.lesson_speed.slows:
            handler.lesson_speed.end()
        drove_at_s = self._now()
        result = self._robot.drive(speeds, now_s, drove_at_s)
        self._timer.lap(_GUARD)
        self._turned = result.wheel_speeds != STANDSTILL
        if result.latched and not self._latched:
            handler.stops.newest_tick = tick
        self._latched = result.latched
        self._driving = decision.driving and not result.latched
        asks = self._options.asks_at_bumper and self._bumpers.update(decision, result) and handler.teacher_available
        # In phase 5 the robot does not wait: the critic can still punish the RLA that pushes, and replace its action.
        self._waits = asks and handler.phase is not AUTONOMOUS
        return Guarded(result, drove_at_s, asks, self._driving and not self._waits)

    def _learn(self, tick: int, view: Perceived, choice: Decided, motion: Guarded) -> Surprise | None:
        """Count, remember and learn; return the surprise of an RLA that ended (step 5)."""
        handler, decision, turning = self._handler, choice.decision, motion.turning
        pace = handler.lesson_speed
        if turning:
            self._perception.remember_driven(decision.wheel_speeds)
        surprise = None
        if self._expectations is not None:
            surprise = self._expectations.update(
                tick,
                decision,
                view.situation,
                choice.behaviour,
                driving=turning,
                slow=pace.slows,
                counts=pace.counts,
            )
        self._statistics.count(decision.rla_id if turning else None)
        self._mid_uses.count(decision, driving=turning)
        # No RLA gets credit for ticks at standstill, including guard stops. A bumper stop is the exception: it is the
        # RLA's own doing.
        credited = decision if self._driving else decision._replace(action=None, answers=False)
        handler.recent.add(
            tick,
            None if view.blind else view.situation,
            credited,
            choice.behaviour,
            touches=motion.asks_at_bumper,
            teachable=self._is_teachable(decision, motion),
            slow=pace.slows,
            circumstances=view.appraisal_features,
            opinion=view.opinion,
        )
        asks = motion.asks_at_bumper or (decision.asking and decision.asks_at == BASIC)
        handler.on_decision(tick, asks=asks)
        if handler.mid is not None:
            handler.mid.remember(tick, decision)
        choice.events.extend(handler.updater.learn_from_tick(handler.phase, tick, credited, view.opinion))
        self._timer.lap(_LEARN)
        return surprise

    def _is_teachable(self, decision: Decision, motion: Guarded) -> bool:
        """Return whether a held action may become a lesson about this tick; not while the active behaviour is open."""
        if motion.result.latched or (decision.mid is not None and decision.mid.asks):
            return False
        if decision.cause is _TEACHER:
            return self._handler.authority.held_press is not None
        return decision.cause in _TEACHABLE

    def _publish(
        self,
        tick: int,
        now_s: float,
        readings: SensorReadings,
        view: Perceived,
        choice: Decided,
        motion: Guarded,
        surprise: Surprise | None,
    ) -> TickRecord:
        """Hand lessons to the journal and return the record of the tick (step 6)."""
        for event in choice.events:
            self._event_store.submit(event)
            if self._expectations is not None:
                invalidated_rla = self._expectations.on_event(event)
                if invalidated_rla is not None:
                    self._statistics.drop_follow_ups(invalidated_rla)
        knowledge = None
        if choice.events or tick >= self._publish_knowledge_at:
            knowledge = self._handler.level.system.active_rlas
            self._publish_knowledge_at = tick + _KNOWLEDGE_PERIOD_TICKS
        decision = stopped(choice.decision, DecisionCause.TOUCHES) if motion.asks_at_bumper else choice.decision
        # The later of both times: the clock of a replay stands still within a tick.
        standing_at_s = max(now_s, motion.drove_at_s)
        error = choice.saving_error or self._handler.learner_failure
        standing = self._standing.update(decision, motion.result, standing_at_s, self._handler.stops.active, error)
        results = tell_hindrance(choice.results, standing, motion.result)
        if results and any(result.lesson for result in results):
            self._question.close()
        standing = self._question.update(decision, standing, choice.behaviour, self._turned)
        self._timer.lap(_PUBLISH)
        return TickRecord(
            tick=tick,
            now_s=now_s,
            readings=readings,
            situation=view.situation,
            decision=decision,
            guard_result=motion.result,
            results=results,
            behaviour=choice.behaviour,
            appraisal_features=view.appraisal_features,
            opinion=view.opinion,
            surprise=surprise,
            commands=choice.commands,
            saving_error=choice.saving_error,
            events=tuple(choice.events),
            number=self._number,
            knowledge=knowledge,
            standing=standing,
            question_begins=self._question.begins,
            lesson_speed=self._handler.lesson_speed.share if self._handler.lesson_speed.slows else 1.0,
        )

    def _apply_system_event(self, event: SystemEvent) -> None:
        match event:
            case PairingRenewed(teacher):
                self._handler.authority.reset_sequence(teacher)
            case SpeedChanged(times, falls_behind):
                before, self._handler.authority.speed = self._handler.authority.speed, times
                stop = self._handler.stops.active
                if falls_behind and stop is not None and stop.reason is StopReason.LINK_LOST:
                    self._handler.stops.active = ActiveStop(StopReason.FALLS_BEHIND, str(before))
            case RobotRepositioned():
                if self._handler.mid is not None:
                    self._handler.mid.mid.restart()
                self._handler.level.forget_obstacles()
                self._handler.delay.last_asked_tick = None
                self._question.close()
                if self._appraisal_perception is not None:
                    self._appraisal_perception.forget_turns()
                self._reset_transitions()

    def _handle(self, command: Command, tick: int, view: Perceived) -> tuple[CommandResult, tuple[TeachingEvent, ...]]:
        """Carry out one command; refuse a first copy that needs the situation of a blind robot."""
        assert not isinstance(command, Stream)
        new = not self._handler.was_handled(command.command_id)
        if new and view.blind and _needs_present_situation(command):
            return CommandResult(command.command_id, Outcome(RefusalCode.BLIND)), ()
        result, events = self._handler.handle(command, view.situation, tick)
        if new and result.accepted:
            # A late copy of a resume does not end a new emergency stop.
            if isinstance(command, Resume):
                self._on_resume()
            elif isinstance(command, BeAt):
                self._reset_transitions()
        return result, events

    def _on_resume(self) -> None:
        if self._sensor_watch is not None:
            self._sensor_watch.readmit()
        # The person who says Go may have carried the robot away from what it touched.
        self._handler.level.forget_obstacles()
        if self._latched:
            self._robot.release()
            self._latched = False

    def _reset_transitions(self) -> None:
        """Forget the predecessor: count no transition into the next RLA."""
        self._mid_uses.restart()
        if self._expectations is not None:
            self._expectations.restart()

    def _decision(self, tick: int, situation: Situation, readings: SensorReadings, *, blind: bool) -> Decision:
        """Return the decision of the levels, or of the teacher who drives by hand."""
        handler, authority = self._handler, self._handler.authority
        handler.before_decision(tick, was_driving=self._driving, turned=self._turned)
        causes = handler.causes_to_stand(tick, blind=blind, unsaved=self._saving_error is not None)
        cause = causes[0] if causes else None
        authority.expire(tick)
        if authority.is_manual(tick):
            because = next((each for each in causes if each in _STOPS_HANDS), _TEACHER)
            idle_decision = stopped(self._level.decide(situation, readings, because), because)
            if because is not _TEACHER:
                return idle_decision
            name, wheel_speeds = authority.step(readings)
            handler.sample_manual_drive(tick, readings, wheel_speeds)
            return idle_decision._replace(wheel_speeds=wheel_speeds, action=name)
        decision = stopped(self._level.decide(situation, readings, cause), cause)
        if cause is _UNATTENDED and not (decision.match is not None and decision.match.known):
            # An unknown situation is asked about even without a teacher.
            return decision._replace(cause=DecisionCause.UNKNOWN)
        return decision


def _needs_present_situation(command: Command) -> bool:
    """Return whether a command is about the present sensor readings; the mid level's situation needs none."""
    if not isinstance(command, Teach | Correct):
        return False
    if isinstance(command, Correct) and command.late:
        return False
    return command.level == BASIC and command.decision_tick is None
