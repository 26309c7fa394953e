"""Facts of a decision over the wire and back."""

from collections.abc import Iterator

import pytest

from kurt2rt.channel.protocol.codec import FACTS, decode_answer, encode_answer
from kurt2rt.core.message_fields import WireError
from tests.runs.explain.helpers import Lesson, facts, level, story
from tests.teacher.helpers import teach


@pytest.fixture
def lesson() -> Iterator[Lesson]:
    lesson = Lesson()
    lesson.go_on(5)
    lesson.go_on(5, teach("forward"))
    yield lesson
    lesson.close()


def test_the_facts_of_a_robot_survive_the_wire(lesson: Lesson) -> None:
    told = decode_answer(encode_answer({"why": FACTS.plain_of(lesson.facts)}))
    assert FACTS.read(told["why"]) == lesson.facts


def test_facts_codec_malformed_is_refused() -> None:
    plain = FACTS.plain_of(facts(level((1.0,), story(1, (1.0,), "back", 0.0))))
    for damage in ({"cause": "whim"}, {"basic": None}, {"decided": [1.0]}, {"tick": "soon"}):
        with pytest.raises(WireError):
            FACTS.read({**plain, **damage})
    with pytest.raises(WireError, match="tick "):
        FACTS.read({key: value for key, value in plain.items() if key != "tick"})
    assert FACTS.read({**plain, "weather": "fine"}) == FACTS.read(plain)
