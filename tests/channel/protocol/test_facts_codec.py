"""Facts of a decision over the wire and back."""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.codec import decode_answer, encode_answer
from kurt2rt.channel.protocol.facts_codec import facts_of_plain, plain_of_facts
from kurt2rt.channel.protocol.schema import WireError
from kurt2rt.core.rla.rla import MID
from kurt2rt.runs.explain.collect import LiveExplainer
from kurt2rt.runs.explain.facts import MOST_OTHERS
from tests.runs.explain.helpers import Lesson, facts, level, story, with_mid
from tests.teacher.helpers import teach


@pytest.fixture
def lesson() -> Iterator[Lesson]:
    lesson = Lesson()
    lesson.go_on(5)
    lesson.go_on(5, teach("forward"))
    yield lesson
    lesson.close()


def test_the_facts_of_a_robot_survive_the_wire(lesson: Lesson) -> None:
    told = decode_answer(encode_answer({"why": plain_of_facts(lesson.facts)}))
    assert facts_of_plain(told["why"]) == lesson.facts


def test_facts_codec_not_finite_is_null() -> None:
    place = story(12, (0.0, 1.0), "turn_left", math.inf)
    lost = replace(level((math.nan, 1.0), place), driver=None, level=MID)
    asks = replace(with_mid(facts(level((1.0,)), "unknown", None), lost), asks_at=MID, infrared_age_s=math.inf)
    plain = plain_of_facts(asks)
    assert plain["mid"]["vector"] == [None, 1.0]
    again = facts_of_plain(decode_answer(encode_answer(plain)))
    assert repr(again) == repr(asks)


def test_facts_codec_keeps_nearest_rlas_and_count() -> None:
    crowd = level((0.0,), *(story(rla_id, (float(rla_id),), "back", float(rla_id)) for rla_id in range(1, 50)))
    again = facts_of_plain(plain_of_facts(facts(crowd)))
    assert [each.rla_id for each in again.basic.others] == list(range(2, 2 + MOST_OTHERS))
    assert again.basic.count == 49


def test_facts_codec_malformed_is_refused() -> None:
    plain = plain_of_facts(facts(level((1.0,), story(1, (1.0,), "back", 0.0))))
    for damage in ({"cause": "whim"}, {"basic": None}, {"decided": [1.0]}, {"tick": "soon"}):
        with pytest.raises(WireError):
            facts_of_plain({**plain, **damage})
    with pytest.raises(WireError, match=" tick"):
        facts_of_plain({key: value for key, value in plain.items() if key != "tick"})
    assert facts_of_plain({**plain, "weather": "fine"}) == facts_of_plain(plain)


def test_live_facts_are_collected_once_per_tick(lesson: Lesson) -> None:
    stamps_read = Counter[str]()

    def stamp_of(command_id: str) -> str:
        stamps_read[command_id] += 1
        return ""

    explaining = LiveExplainer(lesson.runtime, stamp_of)
    assert explaining.facts() is None
    for record in (lesson.records[-1], lesson.go_on(1)):
        explaining.follow(record)
        before = stamps_read.total()
        facts = explaining.facts()
        assert facts is not None
        assert facts.tick == record.tick
        collected = stamps_read.total()
        assert collected > before
        assert explaining.facts() == facts
        assert stamps_read.total() == collected
