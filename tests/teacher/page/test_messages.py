import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.decision.goal import NamedGoal
from kurt2rt.core.message_fields import WireError
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import Correct, Seek, SetPhase, StopSeeking
from kurt2rt.teacher.page.messages import (
    COMMANDS,
    LONGEST_MESSAGE,
    Hidden,
    HoldPress,
    PageCommand,
    PageHeartbeat,
    Press,
    Release,
    StopNow,
    parse,
)


def command(path: str, **fields: object) -> dict[str, object]:
    return {"kind": "command", "number": 1, "path": path, "fields": fields, "picture": 4}


@pytest.mark.parametrize(
    ("said", "understood"),
    [
        ({"kind": "beat", "picture": 7, "at_ms": 12.5}, PageHeartbeat(7, 12.5)),
        ({"kind": "hidden"}, Hidden()),
        ({"kind": "hold", "press_id": 2, "action": "forward", "picture": None}, HoldPress(2, "forward", None)),
        ({"kind": "press", "press_id": 2, "left_m_s": 0.3, "right_m_s": -1, "picture": 9}, Press(2, 0.3, -1.0, 9)),
        ({"kind": "release"}, Release()),
        ({"kind": "stop", "number": 3}, StopNow(3)),
        (
            command("/correct", action="turn_left", level="mid", decision_tick=40),
            PageCommand(1, Correct, {"action": "turn_left", "level": "mid", "decision_tick": 40}, 4),
        ),
        (command("/phase", phase=2), PageCommand(1, SetPhase, {"phase": Phase.CORRECTIONS}, 4)),
        (command("/seek", goal="door"), PageCommand(1, Seek, {"goal": NamedGoal("door")}, 4)),
        (command("/seek/stop"), PageCommand(1, StopSeeking, {}, 4)),
    ],
)
def test_parse_returns_the_message(said: dict[str, Any], understood: object) -> None:
    assert parse(json.dumps(said)) == understood


def order(path: str, /, **fields: object) -> str:
    return json.dumps(command(path, **fields))


@pytest.mark.parametrize(
    "said",
    [
        *("", "{", "[" * 500, "{}", '{"kind": "drive"}', order("/stop"), order("/hello"), order("/answer")),
        *(
            '{"kind": "stop", "number": true}',
            '{"kind": "stop", "number": 0}',
            '{"kind": "stop", "number": 1, "more": 2}',
        ),
        '{"kind": "beat", "picture": 1, "at_ms": NaN}',
        '{"kind": "beat", "picture": 1.5, "at_ms": 0}',
        '{"kind": "hold", "press_id": 1, "action": "", "picture": 1}',
        '{"kind": "hold", "press_id": 0, "action": "forward", "picture": 1}',
        '{"kind": "press", "press_id": 1, "left_m_s": 2.01, "right_m_s": 0, "picture": 1}',
        '{"kind": "press", "press_id": 1, "left_m_s": Infinity, "right_m_s": 0, "picture": 1}',
        '{"kind": "press", "press_id": 1, "left_m_s": ' + "9" * 400 + ', "right_m_s": 0, "picture": 1}',
        order("/drive", press_id=1, left_m_s=0.1, right_m_s=0.1),
        order("/upload", boot="", upload="00" * 8, offset=0, part=""),
        order("answer", action="forward"),
        order("/answer", action="forward", level="critic"),
        order("/answer", action="x" * 65),
        order("/answer", action="forward", of=1),
        order("/answer", action="forward", seen_tick=1),
        order("/answer", action="forward", command_id="a", teacher="b"),
        order("/save", boot="00" * 4),
        order("/reward", value=0),
        order("/phase", phase=6),
        order("/world/place", x_m=1001, y_m=0, heading_rad=0),
        json.dumps({**command("/resume"), "fields": None}),
        json.dumps({**command("/resume"), "more": 1}),
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
        {"kind": st.sampled_from(["beat", "press", "stop", "command"])},
        optional={
            "path": st.sampled_from(sorted(COMMANDS)),
            **dict.fromkeys(
                ("number", "press_id", "picture", "at_ms", "left_m_s", "right_m_s"),
                st.integers() | st.floats() | st.none() | st.booleans(),
            ),
            "fields": st.dictionaries(
                st.sampled_from(("action", "level", "goal", "name")) | st.text(max_size=8),
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
        return order("/load", upload=upload, sha256="ab" * 32)

    parsed = parse(load("0f" * 8))
    assert isinstance(parsed, PageCommand)
    assert parsed.fields == {"upload": b"\x0f" * 8, "sha256": b"\xab" * 32}
    for wrong in ("0f" * 7, "0f" * 9, "zz" * 8):
        with pytest.raises(WireError):
            parse(load(wrong))
