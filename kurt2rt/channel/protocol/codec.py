"""Codec of the teacher's channel: requests, answers and the state as CBOR (docs/the-wire.md)."""

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, get_args

from kurt2rt.channel.protocol.limits import BOOT_BYTES
from kurt2rt.channel.protocol.request_types import Request, StreamRequest, TickRequest, stream_request, tick_request
from kurt2rt.channel.protocol.requests import REQUESTS
from kurt2rt.channel.protocol.schema import decode_strictly, encode_plainly
from kurt2rt.channel.protocol.state import HoldState, MidState, ShownState, State, SurpriseState
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.standing import Standing, StandReason
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.teaching.commands import Single, Stop, Stream
from kurt2rt.core.teaching.message_fields import (
    LARGEST_NUMBER,
    LONGEST_TEXT,
    MOST_SEGMENTS,
    SLOWEST_PERCENT,
    Bytes,
    Check,
    Flag,
    Float,
    Int,
    ListOf,
    OneOf,
    OneWord,
    OrNone,
    Row,
    Text,
    WireError,
    checks_of,
    plain,
)
from kurt2rt.core.teaching.progress import WINDOW_S, Progress
from kurt2rt.core.teaching.question import FeatureDifference
from simbridge.contracts.simulation import SimulatedPlace

__all__ = [
    "CONTENT_FORMAT",
    "PATHS",
    "WireError",
    "decode_answer",
    "decode_request",
    "decode_state",
    "encode_answer",
    "encode_request",
    "encode_state",
    "path_of",
]

CONTENT_FORMAT = 60
"""CoAP's content format of application/cbor."""

MOST_REQUEST_BYTES = 1024
MOST_ANSWER_BYTES = 65_507
"""Largest UDP datagram, for worlds with many walls."""

_REQUEST_DEPTH = 4
_STATE_DEPTH = 3
_ANSWER_DEPTH = 8

_COMMANDS = (*get_args(Stream), *(each for each in get_args(Single) if each is not Stop))

PATHS: Mapping[str, Any] = {kind.path: kind for kind in (*REQUESTS, *_COMMANDS)}
"""Class of the request or of the command of each path; /state is not among them."""

_HEADS: Mapping[type, dict[str, Check]] = {kind: checks_of(kind) for kind in (TickRequest, StreamRequest)}
_CHECKS = {path: checks_of(kind) for path, kind in PATHS.items()}
_STREAMS = {kind.path for kind in get_args(Stream)}
_SINGLES = {kind.path for kind in _COMMANDS} - _STREAMS

BODIES: Mapping[str, Mapping[str, Check]] = {
    **_CHECKS,
    **{path: _HEADS[StreamRequest] | _CHECKS[path] for path in _STREAMS},
    **{path: _HEADS[TickRequest] | _CHECKS[path] for path in _SINGLES},
}
"""Name and check of each place in the body of a path, in order."""


def path_of(request: Request) -> str:
    """Return the path that takes a request."""
    return request.command.path if isinstance(request, TickRequest | StreamRequest) else request.path


def encode_request(request: Request) -> bytes:
    """Return the body of a request. Raises WireError if the robot would refuse it."""
    body = [check(name, getattr(request, name)) for name, check in _HEADS.get(type(request), {}).items()]
    own = request.command if isinstance(request, TickRequest | StreamRequest) else request
    body += [plain(check(name, getattr(own, name))) for name, check in _CHECKS[path_of(request)].items()]
    return encode_plainly(body)


def decode_request(path: str, payload: bytes) -> Request:
    """Return the request in a body; `path` is a key of PATHS. Raises WireError."""
    if path not in PATHS:
        raise WireError(f"there is no {path} here")
    body = decode_strictly(payload, most_bytes=MOST_REQUEST_BYTES, most_depth=_REQUEST_DEPTH)
    checks = BODIES[path]
    if not isinstance(body, list) or len(body) != len(checks):
        raise WireError(f"{path} takes a list of {len(checks)}: [{', '.join(checks)}]")
    return build_request(
        path, {name: check(name, each) for (name, check), each in zip(checks.items(), body, strict=True)}
    )


def build_request(path: str, values: Mapping[str, Any]) -> Request:
    """Return the request to a path with these values by the names of `BODIES`.

    A command has no teacher yet; the id of one that counts once lacks the teacher's name.
    """
    kind = PATHS[path]
    if path in _SINGLES:
        return tick_request(kind, **values)
    if path in _STREAMS:
        return stream_request(kind, **values)
    request: Request = kind(**values)
    return request


def encode_answer(answer: Mapping[str, Any]) -> bytes:
    """Return an answer, a map with text keys, as CBOR."""
    return encode_plainly(dict(answer))


def decode_answer(payload: bytes) -> dict[str, Any]:
    """Return the map of an answer. Raises WireError if the payload is no CBOR map with text keys."""
    # Integer keys are allowed: an answer comes from the robot, and phases have numbers.
    answer = decode_strictly(payload, most_bytes=MOST_ANSWER_BYTES, most_depth=_ANSWER_DEPTH, text_keys=False)
    if not isinstance(answer, dict) or not all(isinstance(key, str) for key in answer):
        raise WireError("an answer has to be a map with text keys")
    return answer


_MOST_SYMBOLS = 32
_MOST_STEPS = 32
"""Most steps of a plan; a longer plan is cut."""
_LINE = Text(512)
_NAME = Text(LONGEST_TEXT)
_NUMBER = Int(0, LARGEST_NUMBER)
_ANY_REAL = Float(math.inf)
_FINITE = Float(1e9)

_PLAIN: tuple[tuple[str, str, Check], ...] = (
    ("b", "boot", Bytes(BOOT_BYTES)),
    ("t", "tick", _NUMBER),
    ("ph", "phase", Int(1, 5)),
    ("ir", "infrared_counts", ListOf(Int(0, 65_535), most=64)),
    ("ia", "infrared_age_s", _ANY_REAL),
    ("bp", "bumpers", Int(0, 2**32 - 1)),
    ("by", "cause", _NAME),
    ("act", "action", OrNone(_NAME)),
    ("rla", "rla", OrNone(_NUMBER)),
    ("n", "nearest", OrNone(_NUMBER)),
    ("na", "nearest_action", OrNone(_NAME)),
    ("d", "distance", _ANY_REAL),
    ("r", "radius", _ANY_REAL),
    ("tb", "taught_by", _NAME),
    ("ta", "taught_at", _NAME),
    ("who", "teacher", OrNone(_NAME)),
    ("hand", "by_hand", Flag()),
    ("nr", "rlas", _NUMBER),
    ("nl", "lessons", _NUMBER),
    ("un", "unsaved", _NUMBER),
    ("ses", "session", OrNone(_NAME)),
    ("clk", "clock_s", _FINITE),
    ("g", "guard", ListOf(_LINE, most=16)),
    ("tr", "trouble", _LINE),
    ("lp", "late_p99_ms", _ANY_REAL),
    ("ms", "missed_ticks", _NUMBER),
    ("w", "behaviour", _NAME),
    ("v", "value", OrNone(_FINITE)),
    ("op", "opinion", OrNone(OneOf((-1, 0, 1)))),
    ("on", "opinion_of", OrNone(_NUMBER)),
    ("ag", "agreement", OrNone(Float(1.0))),
    ("tru", "trusted", Flag()),
    ("cr", "role", _NAME),
    ("bs", "bad_share", OrNone(Float(1.0))),
    ("sm", "signals_missing", Row((_NUMBER, _NUMBER))),
    ("aa", "asks_at", OneWord((BASIC, MID))),
    ("go", "goal", _NAME),
    ("pn", "plan", ListOf(_NAME, most=_MOST_STEPS)),
    ("ps", "plan_says", _LINE),
)
"""Key on the wire, field of State, check."""

_WHEELS = Row((_FINITE, _FINITE))
_QUESTION = ListOf(Row((_NAME, _FINITE, _FINITE)), most=32)
_WORDS = ListOf(_NAME, most=_MOST_SYMBOLS)
_MID = (
    _NAME,
    OrNone(_NUMBER),
    OrNone(_NUMBER),
    OrNone(_NAME),
    _ANY_REAL,
    _ANY_REAL,
    _NAME,
    _NAME,
    Flag(),
    Flag(),
    _WORDS,
    _WORDS,
)
"""The fields of MidState."""
_SURPRISE = (_NUMBER, OneWord((BASIC, MID)), _NUMBER, _NUMBER, _ANY_REAL, Flag())
"""The fields of SurpriseState."""
_PROGRESS = (Int(0, WINDOW_S), OrNone(Int(0, 100)), _NUMBER)
"""The fields of Progress."""
_HOLD = (_NAME, _NAME, _NAME, _NUMBER, Flag())
"""The fields of HoldState."""
_SEGMENTS = ListOf(_NUMBER, most=MOST_SEGMENTS)
_SHOWN = (_NAME, _NUMBER, ListOf(_NAME, most=MOST_SEGMENTS), _SEGMENTS, _SEGMENTS)
"""The fields of ShownState."""
_STANDING = (OneWord(tuple(reason.value for reason in StandReason)), Flag(), Flag(), OrNone(_FINITE), _LINE)
"""The fields of Standing but the stop."""
_STOP = (OneWord(tuple(reason.value for reason in StopReason)), _LINE)
"""The fields of ActiveStop."""
_PLACE = OrNone(Row((_FINITE, _FINITE, _FINITE, _FINITE, _NUMBER, _NUMBER)))


def encode_state(state: State) -> bytes:
    """Return the body of /state. Texts that a device would refuse are cut and made printable."""
    picture: dict[str, Any] = {key: _tidied(getattr(state, field), check) for key, field, check in _PLAIN}
    picture["m"] = [state.left_m_s, state.right_m_s]
    picture["ask"] = [[each.name, each.here, each.in_condition] for each in state.question]
    place = state.place
    picture["pl"] = (
        None
        if place is None
        else [place.x_m, place.y_m, place.heading_rad, place.laps, place.collisions, place.world_version]
    )
    picture["mid"] = _row(state.mid, _MID)
    picture["su"] = _row(state.surprise, _SURPRISE)
    picture["pg"] = _row(state.progress, _PROGRESS)
    picture["nv"] = state.nearest_value
    picture["hd"] = _row(state.hold, _HOLD)
    picture["db"] = state.doubt
    picture["dm"] = _row(state.shown, _SHOWN)
    picture["sr"] = _row(state.stopped, _STOP)
    picture["sd"] = _row(state.standing[:-1], _STANDING)
    picture["od"] = list(state.way_m)
    picture["ls"] = round(100 * state.lesson_speed)
    return encode_plainly(picture)


def decode_state(payload: bytes) -> State:
    """Return the state in a body, without other keys. Raises WireError."""
    picture = decode_strictly(payload, most_bytes=MOST_ANSWER_BYTES, most_depth=_STATE_DEPTH)
    if not isinstance(picture, dict):
        raise WireError("a state has to be a map")
    values = {field: check(field, _value(picture, key)) for key, field, check in _PLAIN}
    left_m_s, right_m_s = _WHEELS("wheel speeds", _value(picture, "m"))
    question = tuple(FeatureDifference(*each) for each in _QUESTION("question", _value(picture, "ask")))
    place = _PLACE("place", _value(picture, "pl"))
    mid = OrNone(Row(_MID))("mid level", _value(picture, "mid"))
    surprise = OrNone(Row(_SURPRISE))("surprise", _value(picture, "su"))
    progress = Row(_PROGRESS)("progress", _value(picture, "pg"))
    nearest_value = OrNone(_FINITE)("worth of the nearest", _value(picture, "nv"))
    hold = OrNone(Row(_HOLD))("hold", _value(picture, "hd"))
    doubt = OrNone(_FINITE)("doubt", _value(picture, "db"))
    shown = OrNone(Row(_SHOWN))("shown drive", _value(picture, "dm"))
    if shown is not None and not len(shown[2]) == len(shown[3]) == len(shown[4]):
        raise WireError("shown drive: has to have as many actions as ticks")
    standing = Row(_STANDING)("standing", _value(picture, "sd"))
    left_m, right_m = _WHEELS("way of the wheels", _value(picture, "od"))
    lesson_percent = Int(SLOWEST_PERCENT, 100)("lesson speed", _value(picture, "ls"))
    stop = OrNone(Row(_STOP))("stop", _value(picture, "sr"))
    stopped = None if stop is None else ActiveStop(StopReason(stop[0]), stop[1])
    return State(
        left_m_s=left_m_s,
        right_m_s=right_m_s,
        question=question,
        place=None if place is None else SimulatedPlace(*place),
        mid=None if mid is None else MidState(*mid),
        surprise=None if surprise is None else SurpriseState(*surprise),
        nearest_value=nearest_value,
        doubt=doubt,
        progress=Progress(*progress),
        stopped=stopped,
        hold=None if hold is None else HoldState(*hold),
        shown=None if shown is None else ShownState(*shown),
        standing=_standing(*standing, stopped=stopped),
        lesson_speed=lesson_percent / 100,
        way_m=(left_m, right_m),
        **values,
    )


def _row(
    value: MidState | HoldState | ShownState | SurpriseState | Progress | tuple[Any, ...] | None,
    checks: tuple[Check, ...],
) -> Any:
    if value is None:
        return None
    values = value if isinstance(value, tuple) else [getattr(value, each.name) for each in fields(value)]
    return [_tidied(each, check) for each, check in zip(values, checks, strict=True)]


def _standing(
    reason: str, needs_go: bool, asks: bool, stall_s: float | None, says: str, *, stopped: ActiveStop | None
) -> Standing:
    """Return the standing, with the stop that is its reason."""
    stop = stopped if reason == StandReason.STOPPED else None
    return Standing(StandReason(reason), needs_go, asks, stall_s, says, stop)


def _value(picture: dict[Any, Any], key: str) -> object:
    try:
        value: object = picture[key]
    except KeyError:
        raise WireError(f"the state has no {key!r}") from None
    return value


def _tidied(value: Any, check: Check) -> Any:
    # A line break in an error's text must not make a device refuse the whole state.
    match check:
        case Text():
            return check.cut(value)
        case ListOf(check=inner, most=most):
            return [_tidied(each, inner) for each in value[:most]]
        case OrNone(check=inner) if value is not None:
            return _tidied(value, inner)
        case _:
            return value
