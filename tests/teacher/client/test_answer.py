"""Answers of the robot, decoded, and their text on each surface."""

from typing import Any

import pytest

from kurt2rt.channel.server.reply import plain_outcome
from kurt2rt.core.outcome import RefusalCode, ResultCode
from kurt2rt.core.outcome_text import Surface
from kurt2rt.teacher.client.answer import answer_of
from tests.texts.outcomes import sample


@pytest.mark.parametrize("code", [*ResultCode, *RefusalCode])
def test_answer_of_each_code_gives_the_outcome_back(code: ResultCode | RefusalCode) -> None:
    answer = answer_of("2.04 Changed", {"t": 5, "ok": True, **plain_outcome(sample(code)), "row": 7})
    assert answer.outcome == sample(code)
    assert answer.extra == {"row": 7}


@pytest.mark.parametrize(
    "told",
    [
        *({}, {"code": "of another program", "fields": {}}, {"code": RefusalCode.NO_RLA.value, "fields": {}}),
        *({"code": RefusalCode.NO_RLA.value}, {"code": RefusalCode.NO_RLA.value, "fields": {"rla": {}}}),
        *({"code": 7, "fields": {"rla": 7}}, {"code": [], "fields": []}),
    ],
)
def test_text_on_without_a_known_outcome_is_the_robots(told: dict[str, Any]) -> None:
    answer = answer_of("4.09 Conflict", {"t": 5, "why": "refused", "text": "no", **told})
    assert answer.outcome is None
    assert {answer.text_on(surface) for surface in Surface} == {"no"}
