import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.message_fields import WireError
from kurt2rt.teacher.page.commands import COMMANDS, PageCommand
from kurt2rt.teacher.page.messages import (
    LONGEST_MESSAGE,
    Hidden,
    HoldPress,
    PageHeartbeat,
    Press,
    Release,
    StopNow,
    parse,
)


def lesson(name: str, arguments: dict[str, object]) -> dict[str, object]:
    return {"kind": "order", "number": 1, "name": name, "arguments": arguments, "picture": 4}


@pytest.mark.parametrize(
    ("said", "understood"),
    [
        ({"kind": "beat", "picture": 7, "at_ms": 12.5}, PageHeartbeat(7, 12.5)),
        ({"kind": "hidden"}, Hidden()),
        ({"kind": "hold", "hold": 2, "action": "forward", "picture": None}, HoldPress(2, "forward", None)),
        ({"kind": "press", "hold": 2, "left_m_s": 0.3, "right_m_s": -1, "picture": 9}, Press(2, 0.3, -1.0, 9)),
        ({"kind": "release"}, Release()),
        ({"kind": "stop", "number": 3}, StopNow(3)),
        (
            lesson("correct", {"action": "turn_left", "level": "mid"}),
            PageCommand(1, "correct", {"action": "turn_left", "level": "mid"}, 4),
        ),
        (
            {"kind": "order", "number": 1, "name": "phase", "arguments": {"phase": 2}, "picture": 4},
            PageCommand(1, "phase", {"phase": Phase.CORRECTIONS}, 4),
        ),
        (
            {"kind": "order", "number": 1, "name": "appraise", "arguments": {"appraisal": "bad"}, "picture": 4},
            PageCommand(1, "appraise", {"appraisal": "bad"}, 4),
        ),
    ],
)
def test_parse_returns_the_message(said: dict[str, Any], understood: object) -> None:
    assert parse(json.dumps(said)) == understood


def order(name: str, /, **arguments: object) -> str:
    return json.dumps({"kind": "order", "number": 1, "name": name, "arguments": arguments, "picture": 1})


@pytest.mark.parametrize(
    "said",
    [
        "",
        "{",
        "[" * 500,
        "{}",
        '{"kind": "drive"}',
        '{"kind": "stop", "number": true}',
        '{"kind": "stop", "number": 0}',
        '{"kind": "stop", "number": 1, "more": 2}',
        '{"kind": "beat", "picture": 1, "at_ms": NaN}',
        '{"kind": "beat", "picture": 1.5, "at_ms": 0}',
        '{"kind": "hold", "hold": 1, "action": "", "picture": 1}',
        '{"kind": "hold", "hold": 0, "action": "forward", "picture": 1}',
        '{"kind": "press", "hold": 1, "left_m_s": 2.01, "right_m_s": 0, "picture": 1}',
        '{"kind": "press", "hold": 1, "left_m_s": Infinity, "right_m_s": 0, "picture": 1}',
        '{"kind": "press", "hold": 1, "left_m_s": ' + "9" * 400 + ', "right_m_s": 0, "picture": 1}',
        order("drive"),
        order("answer"),
        order("answer", action="forward"),
        order("answer", action="forward", level="critic", beside=False),
        order("correct", action="forward", level="mid", beside=False),
        order("seek", goal="door"),
        order("answer", action="x" * 65, level="basic", beside=False),
        order("answer", action="forward", level="basic", beside=False, of=1),
        order("undo", lesson=None),
        order("appraise", value=1),
        order("reward", value=0),
        order("phase", phase=6),
        order("place", x_m=101, y_m=0, heading_rad=0),
        json.dumps({"kind": "hidden", "padding": "x" * LONGEST_MESSAGE}),
    ],
)
def test_parse_invalid_message_is_refused_in_one_line(said: str) -> None:
    with pytest.raises(WireError) as refusal:
        parse(said)
    assert str(refusal.value)
    assert "\n" not in str(refusal.value)


@given(
    st.fixed_dictionaries(
        {"kind": st.sampled_from(["beat", "press", "stop", "order"])},
        optional={
            "name": st.sampled_from(sorted(COMMANDS)),
            **dict.fromkeys(
                ("number", "hold", "picture", "at_ms", "left_m_s", "right_m_s"),
                st.integers() | st.floats() | st.none() | st.booleans(),
            ),
            "arguments": st.dictionaries(
                st.sampled_from(("action", "level", "beside", "name")) | st.text(max_size=8),
                st.integers() | st.booleans() | st.sampled_from(("basic", "mid", "door")) | st.text(max_size=8),
                max_size=3,
            ),
        },
    )
)
def test_parse_any_fields_are_parsed_or_refused(fields: dict[str, Any]) -> None:
    try:
        parse(json.dumps(fields))
    except WireError:
        return


def test_parse_load_reads_hexadecimal_fields() -> None:
    def load(upload: str) -> str:
        arguments = {"upload": upload, "sha256": "ab" * 32}
        return json.dumps({"kind": "order", "number": 1, "name": "load", "arguments": arguments, "picture": 1})

    order = parse(load("0f" * 8))
    assert isinstance(order, PageCommand)
    assert order.arguments == {"upload": b"\x0f" * 8, "sha256": b"\xab" * 32}
    for wrong in ("0f" * 7, "0f" * 9, "zz" * 8):
        with pytest.raises(WireError):
            parse(load(wrong))
