"""What the recorder writes of every tick, and what a replay reads: all that went into it, and what came of it."""

import zlib
from typing import NamedTuple

from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Cause, Decision, MidDecision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.decision.plan_step import PlanStep
from kurt2rt.core.expectations.surprise import Surprise
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla import TeachingEvent
from kurt2rt.core.teaching.commands import CommandResult
from kurt2rt.core.teaching.system_events import Input
from kurt2rt.core.tick import TickRecord


class MatchEntry(NamedTuple):
    """The nearest RLA and the one behind it, by their ids."""

    rla_id: int
    distance: float
    radius: float
    known: bool
    runner_up: int | None
    runner_up_distance: float


class MidEntry(NamedTuple):
    """What the mid level commanded; fields as those of MidDecision."""

    behaviour: str
    rla_id: int | None
    match: MatchEntry | None
    asks: bool
    overridden: bool
    event: JunctionEvent | None


class DecisionEntry(NamedTuple):
    """What was decided; fields as those of Decision."""

    wheel_speeds: WheelSpeeds
    cause: Cause
    action: str | None
    rla_id: int | None
    match: MatchEntry | None
    answers: bool
    asks_at: str
    mid: MidEntry | None
    plan: PlanStep | None


class OpinionEntry(NamedTuple):
    """What the critic thought; fields as those of Opinion."""

    value: int
    appraisal: str
    trace_s: float
    rla_id: int | None
    distance: float
    radius: float
    known: bool


class ResultEntry(NamedTuple):
    """What became of a command."""

    command_id: str
    accepted: bool
    text: str
    """For readers only: a replay compares the code."""
    lesson: bool
    code: str | None = None
    """Code of the outcome; None in recordings of before 2026-11-22."""


class TickEntry(NamedTuple):
    """One tick: what a replay feeds in, and what has to come out again, bit for bit."""

    # What went in.
    number: int
    """1, 2, 3 ... of the ticks that were run: where one is missing, it was not recorded."""
    tick: int
    now_s: float
    senses: SensorReadings
    grant: GuardResult
    commands: tuple[Input, ...]
    """Taken from the inbox in this tick, in order."""
    trouble: str | None
    """Why lessons could not be saved in this tick; None when they could."""
    saved: bool
    """Whether statistics were saved after it: those of RLAs that are no more were dropped then."""
    # What came out.
    decision: DecisionEntry
    behaviour: str
    opinion: OpinionEntry | None
    surprise: Surprise | None
    results: tuple[ResultEntry, ...]
    events: tuple[TeachingEvent, ...]
    """What was taught in this tick, by teachers and by the robot itself."""
    situation_crc32: int
    """CRC-32 of the bytes of the situation vector, little-endian float64."""
    knowledge: str | None
    """Hash of what is known after this tick (RlaSystem.knowledge_hash); None in the ticks that do not say."""


def tick_entry(record: TickRecord, *, saved: bool, knowledge: str | None) -> TickEntry:
    """The entry of a tick. `knowledge`: the hash of `record.knowledge` where that is there."""
    return TickEntry(
        record.number,
        record.tick,
        record.now_s,
        record.senses,
        record.guard_result,
        record.commands,
        record.error,
        saved,
        decision_entry(record.decision),
        record.behaviour,
        None if record.opinion is None else _opinion_entry_of(record.opinion),
        record.surprise,
        tuple(_result_entry_of(each) for each in record.results),
        record.events,
        zlib.crc32(record.situation.vector.astype("<f8", copy=False).tobytes()),
        knowledge,
    )


def _result_entry_of(result: CommandResult) -> ResultEntry:
    text = text_of(result.outcome)
    return ResultEntry(result.command_id, result.accepted, text, result.lesson, result.code.value)


def decision_entry(decision: Decision) -> DecisionEntry:
    """A decision with ids in place of RLAs."""
    return DecisionEntry(
        decision.wheel_speeds,
        decision.cause,
        decision.action,
        decision.rla_id,
        match_entry(decision.match),
        decision.answers,
        decision.asks_at,
        None if decision.mid is None else _mid_entry_of(decision.mid),
        decision.plan,
    )


def match_entry(match: Match | None) -> MatchEntry | None:
    """A match with ids in place of RLAs."""
    if match is None:
        return None
    runner_up = None if match.runner_up is None else match.runner_up.rla_id
    return MatchEntry(match.rla.rla_id, match.distance, match.radius, match.known, runner_up, match.runner_up_distance)


def _opinion_entry_of(opinion: Opinion) -> OpinionEntry:
    rla_id = None if opinion.rla is None else opinion.rla.rla_id
    value, appraisal, trace_s, _, distance, radius, known = opinion
    return OpinionEntry(value, appraisal, trace_s, rla_id, distance, radius, known)


def _mid_entry_of(mid: MidDecision) -> MidEntry:
    return MidEntry(mid.behaviour, mid.rla_id, match_entry(mid.match), mid.asks, mid.overridden, mid.event)
