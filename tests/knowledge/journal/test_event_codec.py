import json
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.events import Appraised, LessonRedone, RlaCreated, SituationNamed, TeachingEvent
from kurt2rt.core.rla.rla import MID, Phase
from kurt2rt.knowledge.journal.event_codec import decode_event, encode_event
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.knowledge.lessons import created, deleted, origin, replaced, rewarded, session, undone, withdrawn
from tests.knowledge.refusals import refused
from tests.strategies import EVENTS

NAMED = SituationNamed("door", (1.0, 2.0), MID, origin("name-1", 500))
REDONE = LessonRedone("create-1", origin("redo-1", 510))
APPRAISED = Appraised("good", 1, 390, origin("appraise-1", 400, Phase.CRITIC))


def bits(numbers: Condition) -> bytes:
    return struct.pack(f"{len(numbers)}d", *numbers)


@given(EVENTS)
def test_encode_event_is_decoded_exactly(event: TeachingEvent) -> None:
    text = encode_event(event)
    again = decode_event(text, "here")

    assert again == event
    assert text.isascii()
    assert "\n" not in text
    if isinstance(event, RlaCreated) and isinstance(again, RlaCreated):
        assert bits(again.rla.condition) == bits(event.rla.condition)  # also the sign of a zero


@given(st.text() | st.recursive(st.none() | st.booleans() | st.integers() | st.text(), st.lists).map(json.dumps))
def test_decode_event_foreign_text_is_refused_with_place(text: str) -> None:
    with refused(KnowledgeCode.NOT_AN_EVENT, "k.db: row 7"):
        decode_event(text, "k.db: row 7")


WRONG: tuple[tuple[TeachingEvent, dict[str, list[object]]], ...] = (
    (created(1), {"version": [0, 2, True], "kind": ["dreamt"], "rla_id": [0, 1.0], "tick": [-1], "phase": [6]}),
    (created(1), {"action": [None, "\ud800"], "radius": ["wide"], "behaviour": [None], "level": [1], "mood": ["good"]}),
    (created(1), {"condition": ["1, 2", [1, "2"], [True], [float("nan")], [10**400]]}),
    (rewarded(1), {"value": [0, 2, True], "decided_at_tick": [-1], "said": [2]}),
    (rewarded(1), {"credits": [None, [[1, 0.5, 2]], [[0, 0.5]], [[1, "much"]]]}),
    (APPRAISED, {"value": [2], "appraisal": [1], "decided_at_tick": [-1]}),
    (withdrawn(1), {"instead_of": [None], "action": ["ask"]}),
    (undone("create-1"), {"lesson": [1], "rla_id": [1]}),
    (NAMED, {"name": [None], "situation": ["here", [float("nan")]], "level": [1], "rla_id": [1]}),
    (REDONE, {"lesson": [1]}),
    (session(10)[0], {"name": [None]}),
    (session(10)[1], {"lasted_ticks": [-1]}),
)


@pytest.mark.parametrize(
    ("event", "key", "value"),
    [(event, key, value) for event, fields in WRONG for key, values in fields.items() for value in values],
)
def test_decode_event_wrong_field_is_named(event: TeachingEvent, key: str, value: object) -> None:
    content = json.loads(encode_event(event)) | {key: value}

    with refused(KnowledgeCode.NOT_AN_EVENT, "row 1", key=key):
        decode_event(json.dumps(content), "row 1")


@pytest.mark.parametrize(
    "event",
    [
        *(created(1), replaced(1, "left", "forward"), withdrawn(1), deleted(1), rewarded(1), APPRAISED),
        *(undone("create-1"), REDONE, NAMED, *session(10)),
    ],
)
def test_decode_event_missing_field_is_named(event: TeachingEvent) -> None:
    whole = json.loads(encode_event(event))
    for key in whole:
        part = {name: value for name, value in whole.items() if name != key}
        with refused(KnowledgeCode.NOT_AN_EVENT, key=key):
            decode_event(json.dumps(part), "row 1")
