"""Round trips of all messages, and refusals of malformed ones by WireError alone."""

import math
from dataclasses import astuple, replace
from functools import partial
from typing import Annotated, Any, get_args, get_origin

import cbor2
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kurt2rt.channel.protocol.codec import (
    BODIES,
    PATHS,
    build_request,
    decode_answer,
    decode_request,
    decode_state,
    encode_request,
    encode_state,
    path_of,
)
from kurt2rt.channel.protocol.requests import Request
from kurt2rt.channel.protocol.state import HoldState, MidState, ShownState, State, SurpriseState
from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.decision.standing import ActiveStop, Standing, StopReason
from kurt2rt.core.message_fields import (
    Bytes,
    BytesUpTo,
    Flag,
    Float,
    Int,
    OneOf,
    Text,
    UpTo,
    WireError,
)
from kurt2rt.core.progress import Progress
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.teaching.message_fields import MOST_SEGMENTS, GoalField
from kurt2rt.core.teaching.question import FeatureDifference
from simbridge.contracts.simulation import SimulatedPlace
from tests.channel.states import COMMANDS, SHOWN, SURPRISED, state

BOOT = b"boot"
ID = b"12345678"
NUMBERS = st.integers(0, 2**53)
REALS = st.floats(allow_nan=False)
FINITE = st.floats(-1e9, 1e9)
PRINTABLE = st.characters(categories=("L", "N", "P", "S")) | st.just(" ")
NAMES = st.text(PRINTABLE, max_size=64)
WORDS = st.lists(NAMES, max_size=12).map(tuple)
LEVELS = st.sampled_from((BASIC, MID))


def values(hint: Any) -> st.SearchStrategy[Any]:
    """Return a strategy of all values of an annotated type."""
    if get_origin(hint) is not Annotated:
        (inner,) = (each for each in get_args(hint) if each is not type(None))
        return st.none() | values(inner)
    kind, check = get_args(hint)
    match check:
        case Bytes(length=length):
            return st.binary(min_size=length, max_size=length)
        case BytesUpTo(most=most):
            return st.binary(min_size=1, max_size=min(most, 64))
        case Int(least=least, most=most):
            return st.integers(least, most)
        case Float(most=most):
            return st.floats(-most, most)
        case OneOf(values=allowed, kind=convert):
            return st.sampled_from(allowed).map(convert or (lambda value: value))
        case Flag():
            return st.booleans()
        case Text(most=most, least=least):
            return st.text(PRINTABLE, min_size=least, max_size=most)
        case UpTo(most=most):
            return st.lists(values(get_args(kind)[0]), max_size=min(most, 6)).map(tuple)
        case GoalField():
            feature = st.tuples(NAMES.filter(bool), st.floats(-1e6, 1e6))
            like = st.builds(PartialGoal, st.lists(feature, max_size=3).map(tuple), st.floats(-1e6, 1e6))
            return st.builds(NamedGoal, NAMES.filter(bool)) | st.builds(RlaGoal, st.integers(0, 2**53)) | like
    raise AssertionError(f"no strategy for {check}")


REQUESTS = st.one_of(
    [
        st.fixed_dictionaries({name: values(check.hint) for name, check in BODIES[path].items()}).map(
            partial(build_request, path)
        )
        for path in PATHS
    ]
)


def shown_states(segments: int) -> st.SearchStrategy[ShownState]:
    names, numbers = (st.tuples(*[each] * segments) for each in (NAMES, NUMBERS))
    return st.builds(ShownState, NAMES, NUMBERS, names, numbers, numbers)


def with_its_stop(picture: State) -> State:
    """Return the state with its stop in the standing, if that is the reason."""
    stop = picture.stopped if picture.standing.reason is StandReason.STOPPED else None
    return replace(picture, standing=picture.standing._replace(stop=stop))


STATES = st.builds(
    State,
    boot=st.binary(min_size=4, max_size=4),
    tick=NUMBERS,
    phase=st.integers(1, 5),
    infrared_counts=st.lists(st.integers(0, 1023), max_size=18).map(tuple),
    infrared_age_s=REALS,
    bumpers=st.integers(0, 255),
    left_m_s=FINITE,
    right_m_s=FINITE,
    cause=NAMES,
    action=st.none() | NAMES,
    rla=st.none() | NUMBERS,
    nearest=st.none() | NUMBERS,
    nearest_action=st.none() | NAMES,
    distance=REALS,
    radius=REALS,
    taught_by=NAMES,
    taught_at=NAMES,
    question=st.lists(st.builds(FeatureDifference, NAMES, FINITE, FINITE), max_size=5).map(tuple),
    teacher=st.none() | NAMES,
    by_hand=st.booleans(),
    stopped=st.none() | st.builds(ActiveStop, st.sampled_from(StopReason), NAMES),
    rlas=NUMBERS,
    lessons=NUMBERS,
    unsaved=NUMBERS,
    session=st.none() | NAMES,
    clock_s=FINITE,
    guard=st.lists(NAMES, max_size=4).map(tuple),
    trouble=NAMES,
    late_p99_ms=REALS,
    missed_ticks=NUMBERS,
    place=st.none() | st.builds(SimulatedPlace, FINITE, FINITE, FINITE, FINITE, NUMBERS, NUMBERS),
    behaviour=NAMES,
    value=st.none() | FINITE,
    opinion=st.sampled_from((None, -1, 0, 1)),
    opinion_of=st.none() | NUMBERS,
    agreement=st.none() | st.floats(0.0, 1.0),
    trusted=st.booleans(),
    role=NAMES,
    bad_share=st.none() | st.floats(0.0, 1.0),
    signals_missing=st.tuples(NUMBERS, NUMBERS),
    asks_at=LEVELS,
    mid=st.none()
    | st.builds(
        MidState,
        behaviour=NAMES,
        rla=st.none() | NUMBERS,
        nearest=st.none() | NUMBERS,
        nearest_behaviour=st.none() | NAMES,
        distance=REALS,
        radius=REALS,
        taught_by=NAMES,
        taught_at=NAMES,
        asks=st.booleans(),
        overridden=st.booleans(),
        here=WORDS,
        there=WORDS,
    ),
    surprise=st.none() | st.builds(SurpriseState, NUMBERS, LEVELS, NUMBERS, NUMBERS, REALS, st.booleans()),
    goal=NAMES,
    plan=WORDS,
    plan_says=NAMES,
    nearest_value=st.none() | FINITE,
    shown=st.none() | st.integers(0, MOST_SEGMENTS).flatmap(shown_states),
    hold=st.none() | st.builds(HoldState, NAMES, NAMES, NAMES, NUMBERS, st.booleans()),
    doubt=st.none() | FINITE,
    progress=st.builds(Progress, st.integers(0, 60), st.none() | st.integers(0, 100), NUMBERS),
    standing=st.builds(Standing, st.sampled_from(StandReason), st.booleans(), st.booleans(), st.none() | FINITE, NAMES),
    way_m=st.tuples(FINITE, FINITE),
).map(with_its_stop)

ANYTHING = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**64), 2**64 - 1)
    | st.floats()
    | st.text(max_size=70)
    | st.binary(max_size=9),
    lambda inner: st.lists(inner, max_size=7) | st.dictionaries(st.text(max_size=3), inner, max_size=4),
    max_leaves=9,
)


@given(REQUESTS)
def test_every_request_comes_back_the_same(request_: Request) -> None:
    assert decode_request(path_of(request_), encode_request(request_)) == request_


@given(STATES)
def test_every_state_comes_back_the_same(picture: State) -> None:
    assert decode_state(encode_state(picture)) == picture


@given(st.sampled_from(sorted(PATHS)), st.binary(max_size=80) | st.lists(ANYTHING, max_size=7).map(cbor2.dumps))
@example("/hello", b"")
@example("/hello", b"\x80")
@example("/reward", b"\xd8\x1c\x81\xd8\x1d\x00")
def test_any_bytes_are_a_valid_request_or_are_refused(path: str, payload: bytes) -> None:
    try:
        request = decode_request(path, payload)
    except WireError:
        return
    assert decode_request(path, encode_request(request)) == request
    for value in astuple(request):
        assert not isinstance(value, float) or math.isfinite(value)


@given(st.binary(max_size=80) | ANYTHING.map(cbor2.dumps))
def test_any_bytes_are_a_valid_answer_or_are_refused(payload: bytes) -> None:
    try:
        answer = decode_answer(payload)
    except WireError:
        return
    assert isinstance(answer, dict)


@given(st.sampled_from(sorted(cbor2.loads(encode_state(state())))), ANYTHING)
def test_state_with_any_value_is_valid_or_refused(key: str, anything: object) -> None:
    picture = cbor2.loads(encode_state(state())) | {key: anything}
    try:
        decoded = decode_state(cbor2.dumps(picture))
    except WireError:
        return
    assert decode_state(encode_state(decoded)) == decoded


def refusal(path: str, payload: bytes) -> str:
    with pytest.raises(WireError) as refused:
        decode_request(path, payload)
    return str(refused.value)


def test_request_not_flat_list_is_refused() -> None:
    good = cbor2.dumps([ID, None])
    assert "CBOR" in refusal("/stop", b"")
    assert "CBOR" in refusal("/stop", good[:-1])
    assert "1 bytes" in refusal("/stop", good + b"\x00")
    assert "[command_id, press_id]" in refusal("/stop", cbor2.dumps([ID]))
    assert "[command_id, press_id]" in refusal("/stop", cbor2.dumps({"id": ID}))
    assert "nesting" in refusal("/stop", cbor2.dumps([[[[[ID]]]]]))
    assert "indefinite" in refusal("/stop", b"\x9f" + good[1:] + b"\xff")
    assert "tag 2: " in refusal("/lessons", b"\x81\xc2\x41\x01")
    assert "2000 bytes" in refusal("/stop", b"\x81" * 2000)
    assert "/fly" in refusal("/fly", b"\x80")


@pytest.mark.parametrize(
    ("path", "body", "field"),
    [
        ("/stop", [b"short", None], "command_id"),
        ("/lessons", [True], "count"),
        ("/lessons", [21], "count"),
        ("/watch", [BOOT, -1], "seen_tick"),
        ("/correct", [BOOT, ID, 0, "turn_left", None, "basic", 1], "late"),
        ("/shown", [BOOT, ID, 0, 7, [-1]], "segments.0"),
        ("/hold", [BOOT, 0, 0, ""], "action"),
        ("/hold", [BOOT, 0, 0], "/hold"),
        ("/drive", [BOOT, 0, 0, math.nan, 0.0], "left_m_s"),
        ("/drive", [BOOT, 0, 0, 0.0, 2.01], "right_m_s"),
        ("/world/move", [BOOT, ID, 0, "north", 100.5, 0.0], "dx_m"),
        ("/world/move", [BOOT, ID, 0, "north", 0.0, -math.inf], "dy_m"),
        ("/reward", [BOOT, ID, 0, 0, None], "value"),
        ("/appraise", [BOOT, ID, 0, "", None], "appraisal"),
        ("/seek", [BOOT, ID, 0, ""], "goal"),
        ("/seek", [BOOT, ID, 0, -12], "goal"),
        ("/seek", [BOOT, ID, 0, [[["x", math.nan]], 0.1]], "goal"),
        ("/seek", [BOOT, ID, 0, None], "goal"),
        ("/seek", [BOOT, ID, 0, [[["x", 1]] * 17, 0.1]], "goal"),
        ("/phase", [BOOT, ID, 0, 6], "phase"),
        ("/answer", [BOOT, ID, 0, "turn_left", None, "high", False], "level"),
        ("/answer", [BOOT, ID, 0, "turn_left", None, "mid", 1], "alternative"),
        (
            "/correct",
            [BOOT, ID, 0, "turn_left", None, "mid", False, 0],
            "/correct",
        ),
        (
            "/answer",
            [BOOT, ID, 0, "turn_left"],
            "/answer",
        ),
        ("/answer", [BOOT, ID, 0, "", None, "basic", False], "action"),
        ("/answer", [BOOT, ID, 0, "a\nb", None, "basic", False], "action"),
        ("/answer", [BOOT, ID, 0, "x" * 65, None, "basic", False], "action"),
        ("/behaviour", [BOOT, ID, 0, "forward", 0], "ticks"),
    ],
)
def test_refusal_of_a_value_begins_with_its_field(path: str, body: list[object], field: str) -> None:
    assert refusal(path, cbor2.dumps(body)).startswith(f"{field} ")


def test_a_state_leaves_room_in_its_datagram() -> None:
    assert len(encode_state(state())) < 560
    assert len(encode_state(state(mid=COMMANDS, surprise=SURPRISED, plan=("turn_left",) * 12))) < 900


def test_words_of_the_levels_are_cut_and_tidied_too() -> None:
    untidy = state(mid=COMMANDS._replace(behaviour="turn\nleft", here=("left",) * 40), plan=("straight_on",) * 40)
    picture = decode_state(encode_state(untidy))
    assert picture.mid is not None
    assert (picture.mid.behaviour, picture.mid.here) == ("turn left", ("left",) * 32)
    assert picture.plan == ("straight_on",) * 32


def test_state_with_another_key_is_read_and_without_one_is_not() -> None:
    picture = cbor2.loads(encode_state(state()))
    assert decode_state(cbor2.dumps(picture | {"weather": "fine"})) == state()
    for key in ("b", "t", "sd", "who"):
        with pytest.raises(WireError, match=f"state.{key} "):
            decode_state(cbor2.dumps({name: value for name, value in picture.items() if name != key}))


def test_shown_drive_of_unequal_lists_is_refused() -> None:
    body = cbor2.loads(encode_state(state(shown=SHOWN)))
    body["dm"][2] = ["forward"]
    with pytest.raises(WireError):
        decode_state(cbor2.dumps(body))
