"""Answers of the robot, decoded, and their text on each surface."""

from typing import Any

import pytest

from kurt2rt.channel.server.reply import plain_outcome
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.outcome_text import Surface, text_of
from kurt2rt.teacher.client.answer import answer_of
from tests.texts.outcomes import sample


@pytest.mark.parametrize("code", [*ResultCode, *RefusalCode])
def test_answer_of_each_code_gives_the_outcome_back(code: ResultCode | RefusalCode) -> None:
    answer = answer_of("2.04 Changed", {"t": 5, "ok": True, **plain_outcome(sample(code)), "row": 7})
    assert answer.outcome == sample(code)
    assert answer.extra == {"row": 7}


@pytest.mark.parametrize("body", [{}, {"lesson": 7}, {"lesson": None}])
def test_lesson_of_an_answer_without_an_id_is_none(body: dict[str, Any]) -> None:
    assert answer_of("2.04 Changed", {"t": 5, "ok": True, **body}).lesson is None


def test_lesson_that_a_refusal_names_is_not_its_own() -> None:
    refused = plain_outcome(Outcome.of(RefusalCode.NO_SUCH_LESSON, lesson="phone-0a"))
    assert answer_of("4.09 Conflict", {"t": 5, "why": "refused", **refused}).lesson is None


@pytest.mark.parametrize(
    "told",
    [
        {},
        {"code": "of another program", "fields": {}},
        {"code": RefusalCode.NO_RLA.value, "fields": {}},
        {"code": RefusalCode.NO_RLA.value},
        {"code": RefusalCode.NO_RLA.value, "fields": {"rla": {}}},
        {"code": 7, "fields": {"rla": 7}},
        {"code": [], "fields": []},
    ],
)
def test_text_on_without_a_known_outcome_is_the_robots(told: dict[str, Any]) -> None:
    answer = answer_of("4.09 Conflict", {"t": 5, "why": "refused", "text": "no", **told})
    assert answer.outcome is None
    assert {answer.text_on(surface) for surface in Surface} == {"no"}


def test_text_on_a_surface_names_its_own_control() -> None:
    stopped = Outcome.of(RefusalCode.STOPPED_BY, teachers=("Ann",))
    answer = answer_of("4.09 Conflict", {"t": 5, "why": "stopped", **plain_outcome(stopped)})
    assert answer.text == text_of(stopped, Surface.LOG)
    assert len({answer.text_on(surface) for surface in Surface}) == len(Surface)
