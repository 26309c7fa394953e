"""The facts of a decision as plain values, for CBOR, and back. Names are those of the fields."""

import math
from typing import Any

from hal.robot import WheelSpeeds
from kurt2rt.channel.maps import MapOf, OrNotFinite, plainly
from kurt2rt.channel.schema import Flag, ManyOf, OneWord, OrNone, Real, Row, Text, Whole
from kurt2rt.explain.facts import Act, DecisionFacts, LevelFacts, RlaStory
from kurt2rt.layers.decision import Cause

MOST_OTHERS = 12
"""RLAs that are told behind the nearest: those nearest to the situation."""
_MOST_ACTS = 32
_MOST_FEATURES = 512

_COUNT = Whole(0, 2**53)
_NAME, _LINE = Text(128), Text(512)
_REAL = Real(1e12)
_DISTANCE = OrNotFinite(_REAL, math.inf)
_SPEEDS = Row((_REAL, _REAL))
_VECTOR = ManyOf(OrNotFinite(_REAL, math.nan), most=_MOST_FEATURES)
_STORY = MapOf(
    RlaStory,
    rla_id=_COUNT,
    title=_NAME,
    action=_NAME,
    condition=ManyOf(_REAL, most=_MOST_FEATURES),
    distance=_DISTANCE,
    radius=_REAL,
    acts=ManyOf(
        MapOf(
            Act, text=_LINE, teacher=_NAME, phase=Whole(1, 5), tick=_COUNT, stamp=_NAME, undone=Flag(), changes=Flag()
        ),
        most=_MOST_ACTS,
    ),
    uses=_COUNT,
    uses_since=OrNone(_COUNT),
    rewards=_COUNT,
    punishments=_COUNT,
    value=OrNone(_REAL),
    asks=Flag(),
    leads=Flag(),
)
_LEVEL = MapOf(
    LevelFacts,
    level=_NAME,
    behaviour=_NAME,
    names=ManyOf(_NAME, most=_MOST_FEATURES),
    vector=_VECTOR,
    weights=ManyOf(_REAL, most=_MOST_FEATURES),
    euclidean=Flag(),
    nearest=OrNone(_STORY),
    driver=OrNone(_STORY),
    others=ManyOf(_STORY, most=MOST_OTHERS),
    count=_COUNT,
    words=ManyOf(_NAME, most=_MOST_FEATURES),
    nearest_words=ManyOf(_NAME, most=_MOST_FEATURES),
)


def _facts(decided: tuple[float, float], granted: tuple[float, float], **others: Any) -> DecisionFacts:
    return DecisionFacts(decided=WheelSpeeds(*decided), granted=WheelSpeeds(*granted), **others)


_FACTS = MapOf(
    _facts,
    tick=_COUNT,
    now_s=_REAL,
    robot=_NAME,
    task=_NAME,
    phase=Whole(1, 5),
    cause=OneWord(tuple(cause.value for cause in Cause)),
    action=OrNone(_NAME),
    asks_at=_NAME,
    decided=_SPEEDS,
    granted=_SPEEDS,
    reasons=ManyOf(_NAME, most=16),
    latched=Flag(),
    stopped_because=_LINE,
    trouble=_LINE,
    teacher=_NAME,
    infrared_counts=ManyOf(_COUNT, most=64),
    infrared_age_s=_DISTANCE,
    basic=_LEVEL,
    mid=OrNone(_LEVEL),
    overridden=Flag(),
    plan_says=_LINE,
    kept=_NAME,
    history_frozen=Flag(),
    taught_now=Flag(),
    hindrances=ManyOf(_NAME, most=8),
)


def plain_of_facts(facts: DecisionFacts) -> dict[str, Any]:
    """Maps, lists, texts and numbers; at most MOST_OTHERS of the RLAs behind the nearest of each level."""
    plain: dict[str, Any] = plainly(facts, _FACTS)
    return plain


def facts_of_plain(plain: object) -> DecisionFacts:
    """The facts that were told. Raises kurt2rt.channel.schema.WireError."""
    facts: DecisionFacts = _FACTS("what the robot knows of its decision", plain)
    return facts
