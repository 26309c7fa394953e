"""The tick: the one place that knows the order in which things happen, 100 times a second."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import STANDSTILL, GuardResult, Robot, SensorReadings
from kurt2rt.core.critic.appraisal_features import CircumstancesPerception
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Cause, Decision, MidDecision, standing
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
    def trouble(self) -> str | None:
        """Why lessons cannot be saved at the moment, in one line; None when they can."""
        ...

    def submit(self, event: TeachingEvent) -> None:
        """Keep an event."""
        ...


@dataclass(slots=True)
class InMemoryEventStore:
    """Events kept in a list, in submission order (EventStore)."""

    events: list[TeachingEvent] = field(default_factory=list)
    trouble: str | None = None

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
    grant: GuardResult
    results: tuple[CommandResult, ...]
    """What became of the teacher's commands that this tick took."""
    behaviour: str = ""
    """The taught behaviour that was wanted."""
    circumstances: AppraisalFeatures | None = None
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
        school: CommandHandler,
        inbox: TeacherInbox,
        keeper: EventStore,
        statistics: StatisticsCounter,
        ledger: TickTimer,
        *,
        now: Callable[[], float],
        stale_infrared_s: float,
        circumstances: CircumstancesPerception | None = None,
        expecting: ExpectationTracker | None = None,
        tolerates_stalls: bool = False,
        asks_when_held: bool = True,
    ) -> None:
        """`now` is the runtime's clock; infra-red readings older than `stale_infrared_s` are no situation.

        `circumstances`: what the school's critic looks at. `expecting`: None: nothing is expected.
        `tolerates_stalls`: whether ticks that are missed count against no lease of the teacher, as in a simulation that
        stalls with this program.
        `asks_when_held`: whether the robot asks that touches something and is to drive on toward it.
        """
        self._robot = robot
        self._perception = perception
        self._circumstances = circumstances
        self._level = level
        self._school = school
        self._inbox = inbox
        self._keeper = keeper
        self._statistics = statistics
        self._mid_uses = MidUsageCounter(statistics)
        self._expecting = expecting
        self._ledger = ledger
        self._now = now
        self._stale_infrared_s = stale_infrared_s
        self._driving = self._latched = False
        self._waits = False
        """Whether the robot stood at a bumper in the last tick, and waited for its teacher's answer."""
        self._asks_when_held = asks_when_held
        self._bumpers = BumperWatch()
        self._standing = StandingWatch()
        self._trouble: str | None = None
        self._tell_knowledge_at = 0
        self._run = 0
        self._tolerates_stalls = tolerates_stalls
        self._last_tick: int | None = None

    def run(self, tick: int, now_s: float) -> TickRecord:
        """One tick at `now_s` of the runtime's clock."""
        mark = self._ledger.lap
        self._run += 1
        if self._tolerates_stalls and self._last_tick is not None and tick > self._last_tick + 1:
            self._school.authority.pause(tick - self._last_tick - 1)
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
        commands = self._inbox.take()
        for command in commands:
            if isinstance(command, Watch | Drive):
                self._school.follow(command, tick)
                continue
            if isinstance(command, PairingRenewed):
                self._school.authority.forget(command.teacher)
                continue
            if isinstance(command, SpeedChanged):
                self._school.authority.speed = command.times
                continue
            if isinstance(command, RobotRepositioned):
                self._set_down()
                continue
            new = not self._school.has_taken(command.command_id)
            if new and blind and _is_about_what_is_seen_now(command):
                results.append(CommandResult(command.command_id, Outcome(RefusalCode.BLIND)))
                continue
            result, event = self._school.attend(command, situation, tick)
            results.append(result)
            # Neither a late copy of an old command ends a new emergency stop, nor one that was said before anybody
            # could see it: the senses of this very tick may have brought it.
            if new and result.accepted and isinstance(command, Resume) and self._latched:
                self._robot.release()
                self._latched = False
            if new and result.accepted and isinstance(command, BeAt):
                self._begin_anew()
            if event is not None:
                events.append(event)
        # Looked at once: another thread may change it meanwhile, and a tick has each of its inputs once.
        trouble = self._trouble = self._keeper.trouble
        decision = self._decide(tick, situation, senses, blind=blind)
        behaviour = self._school.wanted.behaviour
        mark(Stage.DECIDE)

        # What names no action gets no speed. The clock is read anew: a tick that was held up must not pass its old
        # decision for a fresh one.
        wheel_speeds = decision.wheel_speeds if decision.driving else STANDSTILL
        drove_at_s = self._now()
        grant = self._robot.drive(wheel_speeds, now_s, drove_at_s)
        mark(Stage.GUARD)

        if grant.latched and not self._latched:
            self._school.stopped_at_tick = tick
        self._latched = grant.latched
        self._driving = decision.driving and not grant.latched
        asks = self._asks_when_held and self._bumpers.update(decision, grant) and self._school.asked
        # Where the critic alone is there, what pushes goes on to be blamed for it, until another action is tried.
        self._waits = asks and self._school.phase is not Phase.AUTONOMOUS
        turning = self._driving and not self._waits
        if turning:
            self._perception.remember_driven(decision.wheel_speeds)
        surprise = None
        if self._expecting is not None:
            surprise = self._expecting.see(tick, decision, situation, behaviour, driving=turning)
            if surprise is not None and surprise.surprising and self._circumstances is not None:
                self._circumstances.be_surprised()
        self._statistics.count(decision.rla_id if turning else None)
        self._mid_uses.count(decision, driving=turning)
        # A robot that stands blames no RLA, also if the guard has it stand; but for a bumper, which stops it for what
        # an RLA wants.
        answered = decision if self._driving else decision._replace(action=None, answers=False)
        self._school.recent.remember(
            tick,
            situation,
            answered,
            behaviour,
            blind=blind,
            touches=asks,
            circumstances=circumstances,
            opinion=opinion,
        )
        if self._school.mid is not None:
            self._school.mid.remember(tick, decision)
        events.extend(self._school.learn(tick, answered, opinion))
        mark(Stage.LEARN)

        for event in events:
            self._keeper.submit(event)
            if self._expecting is not None:
                led_elsewhere = self._expecting.hear(event)
                if led_elsewhere is not None:
                    self._statistics.drop_follow_ups(led_elsewhere)
        knowledge = None
        if events or tick >= self._tell_knowledge_at:
            knowledge = self._school.living
            self._tell_knowledge_at = tick + _TELL_KNOWLEDGE_TICKS
        # A replay's clock stands still within a tick.
        stop = self._school.stopped
        if asks:
            decision = standing(decision, Cause.TOUCHES)
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

    def _set_down(self) -> None:
        """What the mid level comes to next does not follow what was."""
        if self._school.mid is not None:
            self._school.mid.mid.restart()
        self._begin_anew()

    def _begin_anew(self) -> None:
        """What comes next follows from nothing."""
        self._mid_uses.restart()
        if self._expecting is not None:
            self._expecting.restart()

    def _appraise(
        self, tick: int, senses: SensorReadings, *, blind: bool
    ) -> tuple[AppraisalFeatures | None, Opinion | None]:
        """What the critic looks at and thinks, before the teacher's commands of this tick change what it thinks."""
        critic = self._school.critic
        if self._circumstances is None or critic is None:
            return None, None
        circumstances = self._circumstances.perceive(senses, driving=self._driving and not self._waits)
        if blind:
            return None, None
        return circumstances, critic.think(tick, circumstances)

    def _decide(self, tick: int, situation: Situation, senses: SensorReadings, *, blind: bool) -> Decision:
        school, authority = self._school, self._school.authority
        school.look_after(tick, was_driving=self._driving)
        stand = self._reason_to_stand(tick, blind=blind)
        authority.expire(tick)
        if authority.is_manual(tick):
            because = self._unable(blind=blind) or Cause.TEACHER
            aside = standing(self._level.decide(situation, senses, because), because)
            if because is not Cause.TEACHER:
                return aside
            name, wheel_speeds = authority.step(senses)
            return aside._replace(wheel_speeds=wheel_speeds, action=name)
        decision = standing(self._level.decide(situation, senses, stand), stand)
        if stand is Cause.UNATTENDED and not (decision.match is not None and decision.match.known):
            return decision._replace(cause=Cause.UNKNOWN)  # what it does not know it asks, whoever comes
        return decision

    def _reason_to_stand(self, tick: int, *, blind: bool) -> Cause | None:
        school = self._school
        if school.stopped is not None:
            return Cause.STOPPED
        unable = self._unable(blind=blind)
        if unable is not None:
            return unable
        if school.needs_a_teacher and not school.authority.present(tick):
            return Cause.UNATTENDED
        return None

    def _unable(self, *, blind: bool) -> Cause | None:
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
