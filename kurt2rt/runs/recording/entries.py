"""Entry of each tick in a recording: the inputs of the tick and its results."""

import zlib
from typing import NamedTuple

from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Decision, DecisionCause, JunctionEvent, PlanStep
from kurt2rt.core.expectations.expectations import Surprise
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.teaching.commands import CommandResult
from kurt2rt.core.teaching.inbox import Input
from kurt2rt.core.tick_record import TickRecord


class MatchEntry(NamedTuple):
    """Recorded match: a level's nearest RLA and runner-up by their ids, with distances and R."""

    rla_id: int
    distance: float
    radius: float
    known: bool
    runner_up: int | None
    runner_up_distance: float
    image: str | None = None
    """Image in which the nearest RLA was near; None for none."""
    runner_up_image: str | None = None
    """The same of the runner-up."""


class MidEntry(NamedTuple):
    """Recorded command of the mid level, with the fields of MidDecision in their order and RLAs by ids."""

    behaviour: str
    rla_id: int | None
    match: MatchEntry | None
    asks: bool
    overridden: bool
    event: JunctionEvent | None


class DecisionEntry(NamedTuple):
    """Recorded decision, with the fields of Decision in their order and RLAs by their ids."""

    wheel_speeds: WheelSpeeds
    cause: DecisionCause
    action: str | None
    rla_id: int | None
    match: MatchEntry | None
    answers: bool
    asks_at: str
    mid: MidEntry | None
    plan: PlanStep | None
    doubt: float | None
    """None if the task sets no doubt."""
    image: str | None = None
    """Image in which the RLA that drives drove; None for none."""


class OpinionEntry(NamedTuple):
    """Recorded opinion of the critic, with the fields of Opinion in their order and its RLA by its id."""

    value: int
    appraisal: str
    trace_s: float
    rla_id: int | None
    distance: float
    radius: float
    known: bool


class ResultEntry(NamedTuple):
    """Recorded answer to a teacher's command."""

    command_id: str
    accepted: bool
    text: str
    """Sentence for readers; a replay compares the code."""
    lesson: bool
    """True if the command changed knowledge; its acknowledgement then follows when it is durable."""
    code: str
    """Code of the outcome."""


class TickEntry(NamedTuple):
    """Recorded tick: the inputs that a replay needs, and the results that it must reproduce bit for bit."""

    # What went in.
    number: int
    """Consecutive number of executed ticks from 1; a missing number was not recorded."""
    tick: int
    now_s: float
    readings: SensorReadings
    grant: GuardResult
    commands: tuple[Input, ...]
    """Messages taken from the inbox in this tick, in order."""
    saving_error: str | None
    """Reason why lessons could not be saved in this tick; None if they could."""
    saved: bool
    """True if statistics were saved after the tick, which drops those of deleted RLAs."""
    # What came out.
    decision: DecisionEntry
    behaviour: str
    opinion: OpinionEntry | None
    surprise: Surprise | None
    results: tuple[ResultEntry, ...]
    events: tuple[TeachingEvent, ...]
    """Lessons of this tick by teachers and by the robot itself."""
    situation_crc32: int
    """CRC-32 of the situation vector as little-endian float64."""
    knowledge: str | None
    """Hash of the knowledge after this tick (RlaSystem.knowledge_hash); None in ticks without it."""
    lesson_speed: float | None = None
    """Fraction of the decided speeds that was asked of the guard in a slow lesson; None at full speed."""


def tick_entry(record: TickRecord, *, saved: bool, knowledge: str | None) -> TickEntry:
    """Return the entry of a tick. `knowledge`: hash of `record.knowledge`, if the record has it."""
    return TickEntry(
        number=record.number,
        tick=record.tick,
        now_s=record.now_s,
        readings=record.readings,
        grant=record.guard_result,
        commands=record.commands,
        saving_error=record.saving_error,
        saved=saved,
        decision=decision_entry(record.decision),
        behaviour=record.behaviour,
        opinion=None if record.opinion is None else _opinion_entry(record.opinion),
        surprise=record.surprise,
        results=tuple(_result_entry(each) for each in record.results),
        events=record.events,
        situation_crc32=zlib.crc32(record.situation.vector.astype("<f8", copy=False).tobytes()),
        knowledge=knowledge,
        lesson_speed=record.lesson_speed if record.lesson_speed < 1.0 else None,
    )


def _result_entry(result: CommandResult) -> ResultEntry:
    text = text_of(result.outcome)
    return ResultEntry(result.command_id, result.accepted, text, result.lesson, result.code.value)


def decision_entry(decision: Decision) -> DecisionEntry:
    """Return a decision with ids instead of RLAs."""
    mid = decision.mid
    told = None if mid is None else MidEntry._make(mid)._replace(match=match_entry(mid.match))
    image = decision.image or None
    return DecisionEntry._make(decision)._replace(match=match_entry(decision.match), mid=told, image=image)


def match_entry(match: Match | None) -> MatchEntry | None:
    """Return a match with ids instead of RLAs; None for None."""
    if match is None:
        return None
    rla, other = match.rla, match.runner_up
    return MatchEntry(
        rla_id=rla.rla_id,
        distance=match.distance,
        radius=match.radius,
        known=match.known,
        runner_up=None if other is None else other.rla_id,
        runner_up_distance=match.runner_up_distance,
        image=rla.image or None,
        runner_up_image=None if other is None else other.image or None,
    )


def _opinion_entry(opinion: Opinion) -> OpinionEntry:
    return OpinionEntry._make(opinion)._replace(rla_id=None if opinion.rla is None else opinion.rla.rla_id)
