"""State of the robot that its teachers get."""

import math
from collections.abc import Callable

from kurt2rt.channel.protocol.state import HoldState, MidState, ShownState, State, SurpriseState
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from kurt2rt.channel.server.dependencies import ChannelDependencies
from kurt2rt.core.decision.decision import DecisionCause, MidDecision
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.rla.rla import ASK, BASIC, Rla
from kurt2rt.core.teaching.question import FeatureDifference, Question, ask, ask_in_doubt
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runtime import Runtime

_SENSORS = (TroubleCode.SENSORS_UNHEARD, TroubleCode.SENSORS_SILENT)
_LATENESS_EVERY = 20
"""Number of states between two percentiles, which cost more than a state."""


class StateBuilder:
    """Builder of the robot's state for its teachers, from the record of a tick."""

    def __init__(self, runtime: Runtime, parts: ChannelDependencies) -> None:
        self._runtime = runtime
        self._parts = parts
        self._count = 0
        self._late_p99_ms = 0.0
        self._surprise: SurpriseState | None = None
        self._left_ticks = self._right_ticks = 0
        """Encoder ticks since the program started."""

    def on_tick(self, record: TickRecord) -> None:
        """Keep the surprise and the encoder ticks of a tick, which last one tick; call it for each tick."""
        self._surprise = surprise_state(record) or self._surprise
        self._left_ticks += record.readings.encoder_left_ticks
        self._right_ticks += record.readings.encoder_right_ticks

    def pause(self) -> None:
        """Let the next state measure the lateness again; call it in ticks without an observer."""
        self._count = 0

    def build(self, record: TickRecord) -> State:
        """Return the state of the robot after a tick."""
        runtime, parts = self._runtime, self._parts
        decision, readings, commands = record.decision, record.readings, runtime.handler
        match, plan, opinion, agreement = decision.match, decision.plan, record.opinion, commands.agreement
        nearest = None if match is None else match.rla
        metres = runtime.robot.geometry.metres_per_tick
        if self._count % _LATENESS_EVERY == 0:
            self._late_p99_ms = self._late()
        self._count += 1
        return State(
            boot=parts.boot,
            tick=record.tick,
            phase=int(commands.phase),
            infrared_counts=readings.infrared_counts,
            infrared_age_s=readings.infrared_age_s,
            bumpers=readings.bumpers,
            left_m_s=record.guard_result.wheel_speeds.left_m_s,
            right_m_s=record.guard_result.wheel_speeds.right_m_s,
            cause=decision.cause.value,
            action=decision.action,
            rla=decision.rla_id,
            image=decision.image,
            question=self._question(record),
            teacher=commands.authority.teacher,
            by_hand=commands.authority.is_manual(record.tick),
            stopped=commands.stops.active or _latched(record),
            rlas=len(runtime.level.system),
            lessons=runtime.level.system.history.standing,
            unsaved=parts.journal.unsaved(),
            session=commands.clock.session,
            clock_s=commands.clock.ticks(record.tick) * runtime.robot.cycle_s,
            guard=record.guard_result.reasons,
            trouble=parts.journal.saving_error() or parts.bus_trouble() or commands.updater.error or self._urgent(),
            late_p99_ms=self._late_p99_ms,
            missed_ticks=runtime.timer.missed_ticks,
            place=None if parts.world is None else parts.world.place(),
            behaviour=record.behaviour,
            value=None if decision.rla_id is None else float(runtime.reinforcement.value(decision.rla_id)),
            asks_at=decision.asks_at,
            mid=self._mid(record),
            surprise=self._surprise,
            hold=self._hold(),
            doubt=decision.doubt,
            shown=self._shown(record.tick),
            progress=runtime.progress.progress(),
            standing=record.standing,
            lesson_speed=commands.lesson_speed.share,
            way_m=(self._left_ticks * metres, self._right_ticks * metres),
            nearest=None if nearest is None else nearest.rla_id,
            nearest_action=None if nearest is None else nearest.action,
            nearest_image="" if nearest is None else nearest.image,
            distance=math.inf if match is None else match.distance,
            radius=self._radius(decision.asks_at) if match is None else match.radius,
            taught_by="" if nearest is None else nearest.origin.teacher,
            taught_at="" if nearest is None else parts.journal.stamp_of(nearest.origin.command_id),
            nearest_value=None if nearest is None else self._withdrawn_at(nearest),
            opinion=None if opinion is None else opinion.said,
            opinion_of=None if opinion is None or not opinion.known or opinion.rla is None else opinion.rla.rla_id,
            agreement=None if agreement is None else agreement.share,
            trusted=agreement is not None and agreement.trusted,
            role=commands.updater.critic_state.value,
            bad_share=commands.updater.bad_share,
            signals_missing=self._signals_missing(),
            goal="" if plan is None else plan.goal,
            plan=() if plan is None else plan.behaviours,
            plan_says="" if plan is None else plan.says,
        )

    def _question(self, record: TickRecord) -> tuple[FeatureDifference, ...]:
        decision = record.decision
        if decision.asks_at != BASIC or decision.cause not in (DecisionCause.UNKNOWN, DecisionCause.DOUBT):
            return ()
        return basic_question(self._runtime, record).differing

    def _withdrawn_at(self, nearest: Rla) -> float | None:
        if nearest.level != BASIC or nearest.action != ASK:
            return None
        return float(self._runtime.reinforcement.value(nearest.rla_id))

    def _hold(self) -> HoldState | None:
        hold, held_press = self._runtime.handler.holds.newest, self._runtime.handler.authority.held_press
        if hold is None:
            return None
        on = held_press is not None and held_press == hold.press_id
        return HoldState(hold.teacher, hold.action, hold.lesson, hold.lessons, on)

    def _shown(self, tick: int) -> ShownState | None:
        demonstration = self._runtime.handler.demonstration
        segments, press_id = demonstration.segments(tick), demonstration.press_id
        if press_id is None or not segments:
            return None
        actions, from_ticks, ticks = zip(*segments, strict=True)
        return ShownState(demonstration.teacher, press_id, actions, from_ticks, ticks)

    def _late(self) -> float:
        health = self._parts.health()
        return self._runtime.timer.lateness().p99_us / 1000.0 if health is None else health.punctuality.p99_ms

    def _urgent(self) -> str:
        """Return the most urgent trouble of the health report, such as a full disk; it may be 1 s old."""
        health = self._parts.health()
        # Silent sensors are in the decision's cause, without that delay.
        troubles = () if health is None else health.troubles
        urgent = (each for each in troubles if each.urgent and each.code not in _SENSORS)
        return next((f"{each.what}; {each.to_do}" for each in urgent), "")

    def _radius(self, level: str) -> float:
        mid = self._runtime.mid
        return self._runtime.level.system.radius if mid is None or level == BASIC else mid.settings.learning.radius

    def _mid(self, record: TickRecord) -> MidState | None:
        mid, decided = self._runtime.mid, record.mid
        return None if mid is None or decided is None else mid_state(mid, decided, self._parts.journal.stamp_of)

    def _signals_missing(self) -> tuple[int, int]:
        critic, agreement = self._runtime.handler.critic, self._runtime.handler.agreement
        if critic is None or agreement is None:
            return 0, 0
        least = critic.settings.agreement.least
        return max(0, least - agreement.count_for(-1)), max(0, least - agreement.count_for(1))


def basic_question(runtime: Runtime, record: TickRecord, words: SensorWords = NO_WORDS) -> Question:
    """Return what the basic level asks in a tick; `words`: for the robot's sensors."""
    match, vector, names = record.decision.match, record.situation.vector, runtime.definition.names
    question = ask(match, vector, runtime.level.system.weights, names, record.behaviour, words=words)
    if record.decision.cause is DecisionCause.DOUBT and match is not None:
        return ask_in_doubt(question, runtime.level.new_obstacle(match, vector), names)
    return question


def _latched(record: TickRecord) -> ActiveStop | None:
    """Return the guard's stop, which a teacher has to resume; None while the guard lets the robot drive."""
    return ActiveStop(StopReason.GUARD, ", ".join(record.guard_result.reasons)) if record.guard_result.latched else None


def mid_state(mid: MidLevel, decided: MidDecision, stamp_of: Callable[[str], str]) -> MidState:
    """Return the mid level's command and its reason; `stamp_of`: the time when a command's lesson became durable."""
    settings, match = mid.settings, decided.match
    nearest = None if match is None else match.rla
    words = settings.situation.describe
    return MidState(
        behaviour=decided.behaviour,
        rla=decided.rla_id,
        nearest=None if nearest is None else nearest.rla_id,
        nearest_behaviour=None if nearest is None else nearest.action,
        distance=math.inf if match is None else match.distance,
        radius=settings.learning.radius if match is None else match.radius,
        taught_by="" if nearest is None else nearest.origin.teacher,
        taught_at="" if nearest is None else stamp_of(nearest.origin.command_id),
        asks=decided.asks,
        overridden=decided.overridden,
        here=words(mid.vector),
        there=() if nearest is None else words(nearest.condition),
    )


def surprise_state(record: TickRecord) -> SurpriseState | None:
    """Return the surprise of a tick; None if there is none."""
    surprise = record.surprise
    if surprise is None or not surprise.surprising:
        return None
    return SurpriseState(
        tick=record.tick,
        level=surprise.level,
        rla=surprise.rla_id,
        follow_up=surprise.follow_up,
        times=surprise.multiple,
        new=surprise.new_follow_up,
    )
