"""The tick: the one place that knows the order in which things happen, 100 times a second."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import STANDSTILL, GuardResult, Robot, SensorReadings
from kurt2rt.core.critic.appraisal_features import CircumstancesPerception
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Cause, Decision, MidDecision, stopped
from kurt2rt.core.decision.level import Level
from kurt2rt.core.decision.standing import DRIVES, BumperWatch, Standing, StandingWatch
from kurt2rt.core.expectations.surprise import Surprise
from kurt2rt.core.expectations.tracker import ExpectationTracker
from kurt2rt.core.mid.usage_counter import MidUsageCounter
from kurt2rt.core.perception.perception import Perception, Situation
from kurt2rt.core.rla.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.rla import BASIC, Phase, Rla, TeachingEvent
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.commands import BeAt, Command, CommandResult, Correct, Drive, Resume, Teach, Watch
from kurt2rt.core.teaching.inbox import TeacherInbox
from kurt2rt.core.teaching.system_events import Input, PairingRenewed, RobotRepositioned, SpeedChanged
from kurt2rt.platform.ledger import Stage, TickTimer

_TELL_KNOWLEDGE_TICKS = 100
"""How often a record holds all that is known, at least."""


class EventStore(Protocol):
    """Where teaching events go to be kept; answers at once and works outside the tick."""

    @property
    def error(self) -> str | None:
        """Why lessons cannot be saved at the moment, in one line; None when they can."""
        ...

    def submit(self, event: TeachingEvent) -> None:
        """Keep an event."""
        ...


@dataclass(slots=True)
class InMemoryEventStore:
    """Events kept in a list, in submission order (EventStore)."""

    events: list[TeachingEvent] = field(default_factory=list)
    error: str | None = None

    def submit(self, event: TeachingEvent) -> None:
        """Append an event."""
        self.events.append(event)


class TickRecord(NamedTuple):
    """All that one tick saw, decided and did."""

    tick: int
    now_s: float
    senses: SensorReadings
    situation: Situation
    decision: Decision
    guard_result: GuardResult
    results: tuple[CommandResult, ...]
    """What became of the teacher's commands that this tick took."""
    behaviour: str = ""
    """The taught behaviour that was wanted."""
    appraisal_features: AppraisalFeatures | None = None
    """What the critic looks at; None where the robot sees nothing, or has no critic."""
    opinion: Opinion | None = None
    """What the critic thinks of it; None where it was taught nothing, or there is none."""
    surprise: Surprise | None = None
    """What came where an RLA ended in this tick, beside what was expected; None while none ends."""
    commands: tuple[Input, ...] = ()
    """What the tick took from the inbox, in order."""
    trouble: str | None = None
    """Why lessons could not be saved when the tick looked; None when they could."""
    events: tuple[TeachingEvent, ...] = ()
    """What was taught in it, by teachers and by the robot itself."""
    number: int = 0
    """1, 2, 3 ... of the ticks that were run; `tick` skips those that were missed."""
    knowledge: tuple[Rla, ...] | None = None
    """All RLAs that live after it, where something was taught, and once a second; None in the ticks between."""
    standing: Standing = DRIVES
    """Whether the robot drives, and if not why."""

    @property
    def mid(self) -> MidDecision | None:
        """What the mid level commanded; None where there is none."""
        return self.decision.mid


class Tick:
    """bus -> sense -> perceive -> decide -> guard -> bus, then learn and publish.

    A deterministic function of its state, the senses and the commands: no wall clock, no chance that a seed does not
    settle, no I/O but the bus.
    """

    def __init__(
        self,
        robot: Robot,
        perception: Perception,
        level: Level,
        handler: CommandHandler,
        inbox: TeacherInbox,
        event_store: EventStore,
        statistics: StatisticsCounter,
        timer: TickTimer,
        *,
        now: Callable[[], float],
        stale_infrared_s: float,
        appraisal_perception: CircumstancesPerception | None = None,
        expectations: ExpectationTracker | None = None,
        tolerates_stalls: bool = False,
        asks_at_bumper: bool = True,
    ) -> None:
        """`now` is the runtime's clock; infra-red readings older than `stale_infrared_s` are no situation.

        `circumstances`: what the school's critic looks at. `expecting`: None: nothing is expected.
        `tolerates_stalls`: whether ticks that are missed count against no lease of the teacher, as in a simulation that
        stalls with this program.
        `asks_when_held`: whether the robot asks that touches something and is to drive on toward it.
        """
        self._robot = robot
        self._perception = perception
        self._appraisal_perception = appraisal_perception
        self._level = level
        self._handler = handler
        self._inbox = inbox
        self._event_store = event_store
        self._statistics = statistics
        self._mid_uses = MidUsageCounter(statistics)
        self._expectations = expectations
        self._timer = timer
        self._now = now
        self._stale_infrared_s = stale_infrared_s
        self._driving = self._latched = False
        self._waits = False
        """Whether the robot stood at a bumper in the last tick, and waited for its teacher's answer."""
        self._asks_at_bumper = asks_at_bumper
        self._bumpers = BumperWatch()
        self._standing = StandingWatch()
        self._trouble: str | None = None
        self._tell_knowledge_at = 0
        self._run = 0
        self._tolerates_stalls = tolerates_stalls
        self._last_tick: int | None = None

    def run(self, tick: int, now_s: float) -> TickRecord:
        """One tick at `now_s` of the runtime's clock."""
        mark = self._timer.lap
        self._run += 1
        if self._tolerates_stalls and self._last_tick is not None and tick > self._last_tick + 1:
            self._handler.authority.extend_leases(tick - self._last_tick - 1)
        self._last_tick = tick
        senses = self._robot.sense(now_s)
        mark(Stage.SENSE)

        # While the robot waits for its teacher history stands still: autonomy has no waits to learn from.
        situation = self._perception.perceive(senses, history_frozen=not self._driving or self._waits)
        blind = not senses.infrared_age_s <= self._stale_infrared_s
        circumstances, opinion = self._appraise(tick, senses, blind=blind)
        mark(Stage.PERCEIVE)

        results: list[CommandResult] = []
        events: list[TeachingEvent] = []
        commands = self._inbox.pop_all()
        for command in commands:
            if isinstance(command, Watch | Drive):
                self._handler.handle_stream(command, tick)
                continue
            if isinstance(command, PairingRenewed):
                self._handler.authority.reset_sequence(command.teacher)
                continue
            if isinstance(command, SpeedChanged):
                self._handler.authority.speed = command.times
                continue
            if isinstance(command, RobotRepositioned):
                self._on_repositioned()
                continue
            new = not self._handler.was_handled(command.command_id)
            if new and blind and _is_about_what_is_seen_now(command):
                results.append(CommandResult(command.command_id, Outcome(RefusalCode.BLIND)))
                continue
            result, event = self._handler.handle(command, situation, tick)
            results.append(result)
            # Neither a late copy of an old command ends a new emergency stop, nor one that was said before anybody
            # could see it: the senses of this very tick may have brought it.
            if new and result.accepted and isinstance(command, Resume) and self._latched:
                self._robot.release()
                self._latched = False
            if new and result.accepted and isinstance(command, BeAt):
                self._reset_transitions()
            if event is not None:
                events.append(event)
        # Looked at once: another thread may change it meanwhile, and a tick has each of its inputs once.
        trouble = self._trouble = self._event_store.error
        decision = self._decide(tick, situation, senses, blind=blind)
        behaviour = self._handler.active_behaviour.behaviour
        mark(Stage.DECIDE)

        # What names no action gets no speed. The clock is read anew: a tick that was held up must not pass its old
        # decision for a fresh one.
        wheel_speeds = decision.wheel_speeds if decision.driving else STANDSTILL
        drove_at_s = self._now()
        grant = self._robot.drive(wheel_speeds, now_s, drove_at_s)
        mark(Stage.GUARD)

        if grant.latched and not self._latched:
            self._handler.stopped_at_tick = tick
        self._latched = grant.latched
        self._driving = decision.driving and not grant.latched
        asks = self._asks_at_bumper and self._bumpers.update(decision, grant) and self._handler.teacher_available
        # Where the critic alone is there, what pushes goes on to be blamed for it, until another action is tried.
        self._waits = asks and self._handler.phase is not Phase.AUTONOMOUS
        turning = self._driving and not self._waits
        if turning:
            self._perception.remember_driven(decision.wheel_speeds)
        surprise = None
        if self._expectations is not None:
            surprise = self._expectations.see(tick, decision, situation, behaviour, driving=turning)
            if surprise is not None and surprise.surprising and self._appraisal_perception is not None:
                self._appraisal_perception.be_surprised()
        self._statistics.count(decision.rla_id if turning else None)
        self._mid_uses.count(decision, driving=turning)
        # A robot that stands blames no RLA, also if the guard has it stand; but for a bumper, which stops it for what
        # an RLA wants.
        answered = decision if self._driving else decision._replace(action=None, answers=False)
        self._handler.recent.remember(
            tick,
            situation,
            answered,
            behaviour,
            blind=blind,
            touches=asks,
            circumstances=circumstances,
            opinion=opinion,
        )
        if self._handler.mid is not None:
            self._handler.mid.remember(tick, decision)
        events.extend(self._handler.learn(tick, answered, opinion))
        mark(Stage.LEARN)

        for event in events:
            self._event_store.submit(event)
            if self._expectations is not None:
                led_elsewhere = self._expectations.hear(event)
                if led_elsewhere is not None:
                    self._statistics.drop_follow_ups(led_elsewhere)
        knowledge = None
        if events or tick >= self._tell_knowledge_at:
            knowledge = self._handler.active_rlas
            self._tell_knowledge_at = tick + _TELL_KNOWLEDGE_TICKS
        # A replay's clock stands still within a tick.
        stop = self._handler.active_stop
        if asks:
            decision = stopped(decision, Cause.TOUCHES)
        stands = self._standing.update(decision, grant, max(now_s, drove_at_s), stop, trouble)
        mark(Stage.PUBLISH)
        return TickRecord(
            tick,
            now_s,
            senses,
            situation,
            decision,
            grant,
            tuple(results),
            behaviour,
            circumstances,
            opinion,
            surprise,
            commands,
            trouble,
            tuple(events),
            self._run,
            knowledge,
            stands,
        )

    def _on_repositioned(self) -> None:
        """What the mid level comes to next does not follow what was."""
        if self._handler.mid is not None:
            self._handler.mid.mid.restart()
        self._reset_transitions()

    def _reset_transitions(self) -> None:
        """What comes next follows from nothing."""
        self._mid_uses.restart()
        if self._expectations is not None:
            self._expectations.restart()

    def _appraise(
        self, tick: int, senses: SensorReadings, *, blind: bool
    ) -> tuple[AppraisalFeatures | None, Opinion | None]:
        """What the critic looks at and thinks, before the teacher's commands of this tick change what it thinks."""
        critic = self._handler.critic
        if self._appraisal_perception is None or critic is None:
            return None, None
        circumstances = self._appraisal_perception.perceive(senses, driving=self._driving and not self._waits)
        if blind:
            return None, None
        return circumstances, critic.think(tick, circumstances)

    def _decide(self, tick: int, situation: Situation, senses: SensorReadings, *, blind: bool) -> Decision:
        school, authority = self._handler, self._handler.authority
        school.before_decision(tick, was_driving=self._driving)
        stand = self._reason_to_stand(tick, blind=blind)
        authority.expire(tick)
        if authority.is_manual(tick):
            because = self._blocking_cause(blind=blind) or Cause.TEACHER
            aside = stopped(self._level.decide(situation, senses, because), because)
            if because is not Cause.TEACHER:
                return aside
            name, wheel_speeds = authority.step(senses)
            return aside._replace(wheel_speeds=wheel_speeds, action=name)
        decision = stopped(self._level.decide(situation, senses, stand), stand)
        if stand is Cause.UNATTENDED and not (decision.match is not None and decision.match.known):
            return decision._replace(cause=Cause.UNKNOWN)  # what it does not know it asks, whoever comes
        return decision

    def _reason_to_stand(self, tick: int, *, blind: bool) -> Cause | None:
        school = self._handler
        if school.active_stop is not None:
            return Cause.STOPPED
        unable = self._blocking_cause(blind=blind)
        if unable is not None:
            return unable
        if school.requires_teacher and not school.authority.is_present(tick):
            return Cause.UNATTENDED
        return None

    def _blocking_cause(self, *, blind: bool) -> Cause | None:
        """Why neither an RLA nor the teacher's hand may drive."""
        if blind:
            return Cause.BLIND
        if self._trouble is not None:
            return Cause.UNSAVED
        return None


def _is_about_what_is_seen_now(command: Command) -> bool:
    """The mid level has its situation also while the robot sees nothing."""
    if not isinstance(command, Teach | Correct):
        return False
    return command.level == BASIC and command.decision_tick is None
