"""Codec of the facts of a decision."""

import math
from typing import Any

from hal.robot import WheelSpeeds
from kurt2rt.channel.protocol.cbor_schema import COUNT, LINE, NAME, DataclassCodec, MapOf, OrNotFinite
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.teaching.message_fields import Flag, Float, Int, ListOf, OneWord, OrNone, Row
from kurt2rt.runs.explain.facts import (
    MOST_OTHERS,
    ContactFacts,
    DecisionFacts,
    DoubtFacts,
    LessonFact,
    LevelFacts,
    RlaFacts,
)

_MOST_LESSONS = 32
_MOST_FEATURES = 512

_REAL = Float(1e12)
_DISTANCE = OrNotFinite(_REAL, math.inf)
_SPEEDS = Row((_REAL, _REAL))
_VECTOR = ListOf(OrNotFinite(_REAL, math.nan), most=_MOST_FEATURES)
_RLA = MapOf(
    RlaFacts,
    rla_id=COUNT,
    title=NAME,
    action=NAME,
    condition=ListOf(_REAL, most=_MOST_FEATURES),
    distance=_DISTANCE,
    radius=_REAL,
    acts=ListOf(
        MapOf(
            LessonFact, text=LINE, teacher=NAME, phase=Int(1, 5), tick=COUNT, stamp=NAME, undone=Flag(), changes=Flag()
        ),
        most=_MOST_LESSONS,
    ),
    uses=COUNT,
    uses_since=OrNone(COUNT),
    rewards=COUNT,
    punishments=COUNT,
    value=OrNone(_REAL),
    asks=Flag(),
    leads=Flag(),
)
_LEVEL = MapOf(
    LevelFacts,
    level=NAME,
    behaviour=NAME,
    names=ListOf(NAME, most=_MOST_FEATURES),
    vector=_VECTOR,
    weights=ListOf(_REAL, most=_MOST_FEATURES),
    euclidean=Flag(),
    nearest=OrNone(_RLA),
    driver=OrNone(_RLA),
    others=ListOf(_RLA, most=MOST_OTHERS),
    count=COUNT,
    words=ListOf(NAME, most=_MOST_FEATURES),
    nearest_words=ListOf(NAME, most=_MOST_FEATURES),
    radius_share=Float(1.0),
    passed_over=OrNone(_RLA),
)


def _stop(reason: str, name: str) -> ActiveStop:
    return ActiveStop(StopReason(reason), name)


def _facts(decided: tuple[float, float], granted: tuple[float, float], **others: Any) -> DecisionFacts:
    return DecisionFacts(decided=WheelSpeeds(*decided), granted=WheelSpeeds(*granted), **others)


_CONTACT = MapOf(ContactFacts, action=NAME, within_s=_REAL, sensor=NAME, seen_s=_REAL)
_DOUBT = MapOf(
    DoubtFacts,
    score=_REAL,
    threshold=_REAL,
    sensor=NAME,
    reads=NAME,
    taught=NAME,
    contact=OrNone(_CONTACT),
)

_FACTS = MapOf(
    _facts,
    tick=COUNT,
    now_s=_REAL,
    robot=NAME,
    task=NAME,
    phase=Int(1, 5),
    cause=OneWord(tuple(cause.value for cause in DecisionCause)),
    action=OrNone(NAME),
    asks_at=NAME,
    decided=_SPEEDS,
    granted=_SPEEDS,
    reasons=ListOf(NAME, most=16),
    latched=Flag(),
    stopped=OrNone(MapOf(_stop, reason=OneWord(tuple(reason.value for reason in StopReason)), name=LINE)),
    trouble=LINE,
    teacher=NAME,
    infrared_counts=ListOf(COUNT, most=64),
    infrared_age_s=_DISTANCE,
    basic=_LEVEL,
    mid=OrNone(_LEVEL),
    overridden=Flag(),
    plan_says=LINE,
    kept=NAME,
    history_frozen=Flag(),
    taught_now=Flag(),
    hindrances=ListOf(NAME, most=8),
    broken_sensors=ListOf(NAME, most=64),
    lesson_speed=Float(1.0),
    doubt=OrNone(_DOUBT),
)

_FORM = DataclassCodec[DecisionFacts]("what the robot knows of its decision", _FACTS)
plain_of_facts = _FORM.plain_of
"""Encode facts, with at most MOST_OTHERS RLAs after the nearest of each level."""
facts_of_plain = _FORM.read
