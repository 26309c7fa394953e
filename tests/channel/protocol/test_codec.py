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
from kurt2rt.channel.protocol.state import ShownState, State
from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.message_fields import Bytes, BytesUpTo, Flag, Float, Int, OneOf, Text, UpTo, WireError
from kurt2rt.core.teaching.message_fields import MOST_SEGMENTS, GoalField
from tests.channel.states import COMMANDS, SHOWN, SURPRISED, state
from tests.strategies import values_of

GOOD = cbor2.dumps([b"12345678", None])
NUMBERS = st.integers(0, 2**53)
PRINTABLE = st.characters(categories=("L", "N", "P", "S")) | st.just(" ")
NAMES = st.text(PRINTABLE, max_size=64)


def shown_states(segments: int) -> st.SearchStrategy[ShownState]:
    names, numbers = (st.tuples(*[each] * segments) for each in (NAMES, NUMBERS))
    return st.builds(ShownState, NAMES, NUMBERS, names, numbers, numbers)


PLAIN: dict[Any, st.SearchStrategy[Any]] = {
    int: NUMBERS,
    float: st.floats(-1e9, 1e9),
    ShownState: st.integers(0, MOST_SEGMENTS).flatmap(shown_states),
}


def values(hint: Any) -> st.SearchStrategy[Any]:
    """Return a strategy of all values of a type, whose fields have checks."""
    return values_of(hint, checked)


def checked(hint: Any) -> st.SearchStrategy[Any] | None:
    """Return a strategy of all values that the check of a type takes."""
    if get_origin(hint) is not Annotated:
        return PLAIN.get(hint)
    kind, check, *_ = get_args(hint)
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
            return st.text(PRINTABLE, min_size=least, max_size=min(most, 64))
        case UpTo(most=most):
            return st.lists(values(get_args(kind)[0]), max_size=min(most, 6)).map(tuple)
        case GoalField():
            feature = st.tuples(NAMES.filter(bool), st.floats(-1e6, 1e6))
            like = st.builds(PartialGoal, st.lists(feature, max_size=3).map(tuple), st.floats(-1e6, 1e6))
            return st.builds(NamedGoal, NAMES.filter(bool)) | st.builds(RlaGoal, st.integers(0, 2**53)) | like
    return values(kind)


REQUESTS = st.one_of(
    [
        st.fixed_dictionaries({name: values(check.hint) for name, check in BODIES[path].items()}).map(
            partial(build_request, path)
        )
        for path in PATHS
    ]
)


def with_its_stop(picture: State) -> State:
    """Return the state with its stop in the standing, if that is the reason."""
    stop = picture.stopped if picture.standing.reason is StandReason.STOPPED else None
    return replace(picture, standing=picture.standing._replace(stop=stop))


STATES = values(State).map(with_its_stop)

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


@pytest.mark.parametrize(
    ("payload", "told"),
    [(b"", "CBOR"), (GOOD[:-1], "CBOR"), (b"\x9f" + GOOD[1:] + b"\xff", "indefinite"), (b"\x81" * 5 + GOOD, "nesting")],
)
def test_payload_of_other_cbor_is_refused(payload: bytes, told: str) -> None:
    with pytest.raises(WireError, match=told):
        decode_request("/stop", payload)


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
